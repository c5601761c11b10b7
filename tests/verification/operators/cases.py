#!/usr/bin/python3
"""A: sums over the kernel, without a run."""

from verify_cases import Program

CASES = [
    Program("A1", "lattice sums of four kernels", "T0", "neighbours/kernel_test", "*", "table of the catalogue [N]",
            "every value to its printed digits"),
    Program("A2", "gradients of linear and quadratic fields on faces, edges, corners and jitter (A2, A3)", "T0",
            "mechanics/gradient_test", "*", "exact [E]", "linear field 1e-12 everywhere; quadratic field first order (0.9)"),
]
