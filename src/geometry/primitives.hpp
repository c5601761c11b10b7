/// Primitive solids with exact signed distance and outward normal. Lengths in m, in the shape's own frame.
///
/// Where several surface points are nearest (the axis of a cylinder, the centre of a sphere) one of the possible
/// normals is returned, always the same one. Two-dimensional spaces use the same solids at z = 0: an endless cylinder
/// along z is a disc, a box with two coordinates is a rectangle.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "geometry/shape.hpp"

namespace stirsph {

/// All points with (x - point).normal <= 0: the normal points out of the solid.
class HalfSpace final : public ShapeFunction {
 public:
  HalfSpace(const Vec3& point, const Vec3& normal);
  SurfacePoint nearest(const Vec3& point) const override;
  Bounds bounds() const override;
  std::string describe() const override;
  void accept(ShapeVisitor& visitor) const override { visitor.visit(*this); }
  const Vec3& point() const { return point_; }
  const Vec3& normal() const { return normal_; }

 private:
  Vec3 point_, normal_;
};

/// Axis-aligned box; any of its bounds may be infinite.
class Box final : public ShapeFunction {
 public:
  Box(const Vec3& low, const Vec3& high);
  SurfacePoint nearest(const Vec3& point) const override;
  Bounds bounds() const override { return bounds_; }
  std::string describe() const override;
  void accept(ShapeVisitor& visitor) const override { visitor.visit(*this); }

 private:
  Bounds bounds_;
};

class Sphere final : public ShapeFunction {
 public:
  Sphere(const Vec3& centre, double radius);
  SurfacePoint nearest(const Vec3& point) const override;
  Bounds bounds() const override;
  std::string describe() const override;
  void accept(ShapeVisitor& visitor) const override { visitor.visit(*this); }
  const Vec3& centre() const { return centre_; }
  double radius() const { return radius_; }

 private:
  Vec3 centre_;
  double radius_;
};

/// A ring of circular section about the axis through `centre`.
class Torus final : public ShapeFunction {
 public:
  Torus(const Vec3& centre, const Vec3& axis, double ring_radius, double section_radius);
  SurfacePoint nearest(const Vec3& point) const override;
  Bounds bounds() const override;
  std::string describe() const override;
  void accept(ShapeVisitor& visitor) const override { visitor.visit(*this); }
  const Vec3& centre() const { return centre_; }
  const Vec3& axis() const { return axis_; }
  double ring_radius() const { return ring_radius_; }
  double section_radius() const { return section_radius_; }

 private:
  Vec3 centre_, axis_;
  double ring_radius_, section_radius_;
};

/// A cylinder or annulus without ends, both ways along the axis. inner_radius 0: no hole.
class EndlessTube final : public ShapeFunction {
 public:
  EndlessTube(const Vec3& base, const Vec3& axis, double inner_radius, double outer_radius);
  SurfacePoint nearest(const Vec3& point) const override;
  Bounds bounds() const override;
  std::string describe() const override;
  void accept(ShapeVisitor& visitor) const override { visitor.visit(*this); }
  const Vec3& base() const { return base_; }
  const Vec3& axis() const { return axis_; }
  double inner_radius() const { return inner_radius_; }
  double outer_radius() const { return outer_radius_; }

 private:
  Vec3 base_, axis_;
  double inner_radius_, outer_radius_;
};

/// From the base along the axis; without a height endless both ways.
ShapePointer make_cylinder(const Vec3& base, const Vec3& axis, double radius, std::optional<double> height);
ShapePointer make_annulus(const Vec3& base, const Vec3& axis, double inner_radius, double outer_radius,
                          std::optional<double> height);
/// A cone cut by two planes: one radius at the base, the other at the top; one of them may be 0.
ShapePointer make_frustum(const Vec3& base, const Vec3& axis, double base_radius, double top_radius, double height);

}  // namespace stirsph
