/// Unions, intersections and differences of shapes.
///
/// An intersection's distance is the largest of its members' distances, which is exact inside. Outside, beyond an edge
/// where two members meet, that would be too small; there the edge of the two tangent planes is used. This is exact for
/// plane faces and for a cylinder cut square to its axis, and correct to first order in distance / radius of curvature
/// otherwise; beyond a corner of three members it is a lower bound. A union is the same with inside and outside
/// exchanged: exact outside, first order inside near a concave edge. The sign is always right.
#pragma once

#include <memory>
#include <vector>

#include "geometry/shape.hpp"

namespace stirsph {

class Intersection final : public ShapeFunction {
 public:
  explicit Intersection(std::vector<ShapePointer> members);
  SurfacePoint nearest(const Vec3& point) const override;
  Bounds bounds() const override;
  std::string describe() const override;
  void accept(ShapeVisitor& visitor) const override { visitor.visit(*this); }
  const std::vector<ShapePointer>& members() const { return members_; }

 private:
  std::vector<ShapePointer> members_;
};

class Union final : public ShapeFunction {
 public:
  explicit Union(std::vector<ShapePointer> members);
  SurfacePoint nearest(const Vec3& point) const override;
  Bounds bounds() const override;
  std::string describe() const override;
  void accept(ShapeVisitor& visitor) const override { visitor.visit(*this); }
  const std::vector<ShapePointer>& members() const { return members_; }

 private:
  std::vector<ShapePointer> members_;
};

/// What is left of a shape when others are cut out of it.
class Difference final : public ShapeFunction {
 public:
  Difference(ShapePointer shape, std::vector<ShapePointer> removed);
  SurfacePoint nearest(const Vec3& point) const override;
  Bounds bounds() const override { return shape_->bounds(); }
  std::string describe() const override;
  void accept(ShapeVisitor& visitor) const override { visitor.visit(*this); }
  const ShapeFunction& shape() const { return *shape_; }
  const std::vector<ShapePointer>& removed() const { return removed_; }

 private:
  ShapePointer shape_;
  std::vector<ShapePointer> removed_;
};

}  // namespace stirsph
