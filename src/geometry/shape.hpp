/// Shapes as signed distance functions: exact for the primitives, so that contact has no facets.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/tensor.hpp"

namespace stirsph {

/// Axis-aligned bounds; infinite where the shape is.
struct Bounds {
  Vec3 low, high;
};

/// A point's relation to a surface. Distance is positive outside the shape, negative inside; the normal is the outward
/// unit normal of the nearest surface point (the gradient of the distance).
struct SurfacePoint {
  double distance;  ///< m
  Vec3 normal;
};

class HalfSpace;
class Box;
class Sphere;
class Torus;
class EndlessTube;
class RevolvedProfile;
class Union;
class Intersection;
class Difference;

/// For code that needs more than a shape's distance, such as the mesher: receives the shape as what it is.
class ShapeVisitor {
 public:
  virtual ~ShapeVisitor() = default;
  virtual void visit(const HalfSpace& shape) = 0;
  virtual void visit(const Box& shape) = 0;
  virtual void visit(const Sphere& shape) = 0;
  virtual void visit(const Torus& shape) = 0;
  virtual void visit(const EndlessTube& shape) = 0;
  virtual void visit(const RevolvedProfile& shape) = 0;
  virtual void visit(const Union& shape) = 0;
  virtual void visit(const Intersection& shape) = 0;
  virtual void visit(const Difference& shape) = 0;
};

/// A solid region of space in its own frame.
class ShapeFunction {
 public:
  virtual ~ShapeFunction() = default;
  virtual SurfacePoint nearest(const Vec3& point) const = 0;
  virtual Bounds bounds() const = 0;
  virtual std::string describe() const = 0;
  virtual void accept(ShapeVisitor& visitor) const = 0;
  double distance(const Vec3& point) const { return nearest(point).distance; }
};
using ShapePointer = std::shared_ptr<const ShapeFunction>;

}  // namespace stirsph
