/// When to cut the cells anew.
#pragma once

#include <algorithm>

namespace stirsph {

/// Asks for a new partition when the imbalance is above the limit, unless the last cut could not do better: parts of a
/// few cells cannot be even, and cutting them again at every renewal of the lists is in vain. So the imbalance must
/// have grown by a margin, half of what the limit allows over 1, above the best that was seen since the last cut.
class RepartitionRule {
 public:
  /// `limit`: largest over mean cost that is allowed, > 1.
  explicit RepartitionRule(double limit) : limit_(limit) {}

  /// Whether to cut now, by the costs that this imbalance comes from. Call once per renewal of the lists, with the same
  /// number on all ranks.
  bool asks(double imbalance) {
    if (reached_ == unknown) {  // the list of the last cut is the first that tells what it reached
      reached_ = imbalance;
      return false;
    }
    const bool cut = imbalance > std::max(limit_, reached_ + 0.5 * (limit_ - 1));
    reached_ = cut ? unknown : std::min(reached_, imbalance);
    return cut;
  }

  /// The rule's memory, part of the state of a run.
  double state() const { return reached_; }
  void restore(double state) { reached_ = state; }

 private:
  static constexpr double unknown = 0;

  double limit_;
  double reached_ = 1;  ///< a first cut by numbers of particles proves nothing about one by cost: as if it were perfect
};

}  // namespace stirsph
