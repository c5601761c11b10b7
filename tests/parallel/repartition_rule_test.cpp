/// The cells are cut anew when that can help, and not in vain.
#include "parallel/repartition_rule.hpp"

#include <gtest/gtest.h>

namespace stirsph::testing {
namespace {

TEST(RepartitionRule, FirstCutIsReplacedAsSoonAsTheLimitIsPassed) {
  RepartitionRule rule(1.2);
  EXPECT_FALSE(rule.asks(1.0));
  EXPECT_FALSE(rule.asks(1.2));
  EXPECT_TRUE(rule.asks(1.21));
}

TEST(RepartitionRule, DoesNotCutInVain) {
  RepartitionRule rule(1.2);
  ASSERT_TRUE(rule.asks(1.5));
  EXPECT_FALSE(rule.asks(1.4)) << "what the cut reached";
  for (int list = 0; list < 10; ++list) EXPECT_FALSE(rule.asks(1.45)) << "within the margin of 0.1";
  EXPECT_TRUE(rule.asks(1.51));
}

TEST(RepartitionRule, LimitHoldsAfterAGoodCut) {
  RepartitionRule rule(1.2);
  ASSERT_TRUE(rule.asks(1.3));
  EXPECT_FALSE(rule.asks(1.02));
  EXPECT_FALSE(rule.asks(1.19)) << "far above what was reached, but allowed";
  EXPECT_TRUE(rule.asks(1.21));
}

TEST(RepartitionRule, AnImprovementCounts) {
  RepartitionRule rule(1.2);
  ASSERT_TRUE(rule.asks(2.0));
  EXPECT_FALSE(rule.asks(1.6));
  EXPECT_FALSE(rule.asks(1.3)) << "the material has come to suit the parts";
  EXPECT_TRUE(rule.asks(1.45)) << "what had been reached before does not matter any more";
}

TEST(RepartitionRule, MemorySurvivesARestart) {
  RepartitionRule rule(1.2), fresh(1.2), continued(1.2);
  ASSERT_TRUE(rule.asks(1.5));
  ASSERT_FALSE(rule.asks(1.4));
  EXPECT_TRUE(fresh.asks(1.45));
  continued.restore(rule.state());
  EXPECT_FALSE(continued.asks(1.45));
}

}  // namespace
}  // namespace stirsph::testing
