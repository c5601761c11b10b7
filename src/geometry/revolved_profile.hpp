/// Solids of revolution from a closed profile of straight lines and fillets, with exact signed distance. Lengths in m.
#pragma once

#include <string>
#include <vector>

#include "geometry/shape.hpp"

namespace stirsph {

/// A closed profile in the meridian half-plane (r >= 0, z along the axis from the base) turned about the axis:
/// cylinders, annuli, frustums, tools with land and relief, tapered dies.
///
/// The nearest surface point of a solid of revolution lies in the meridian plane of the point asked for, so the
/// distance is that of the plane profile: exact to its lines and arcs. Inside or outside follows from the crossings of
/// the profile with a ray. Lines on the axis are no surface; the profile may also stay away from the axis (a ring).
class RevolvedProfile final : public ShapeFunction {
 public:
  struct Vertex {
    double r, z;        ///< m
    double fillet = 0;  ///< m, radius of the arc that replaces the corner; 0: sharp
  };
  /// A straight line, or an arc that does not turn back in z.
  struct Edge {
    double start_r, start_z, end_r, end_z;  ///< m
    double dr, dz;                          ///< line: unit vector; the solid lies to its left
    double length;                          ///< m, straight from start to end
    bool is_surface;                        ///< false on the axis
    double radius = 0;                      ///< m; 0: a line
    double centre_r = 0, centre_z = 0;      ///< m, of the arc
    double middle_r = 0, middle_z = 0;      ///< unit vector from the centre to the middle of the arc
    double cos_half = 0;                    ///< cosine of half the angle of the arc
    double outward = 1;                     ///< 1: the normal points away from the centre; -1: towards it (concave)
  };

  /// Vertices in either order; the last one is joined to the first. Throws InputError naming the vertex for a profile
  /// that crosses itself or the axis, repeats a vertex, or has no room for a fillet.
  RevolvedProfile(const Vec3& base, const Vec3& axis, std::vector<Vertex> vertices, std::string description);
  SurfacePoint nearest(const Vec3& point) const override;
  Bounds bounds() const override;
  std::string describe() const override { return description_; }
  void accept(ShapeVisitor& visitor) const override { visitor.visit(*this); }
  const Vec3& base() const { return base_; }
  const Vec3& axis() const { return axis_; }
  /// Counter-clockwise with r to the right and z up, each beginning where the one before ends.
  const std::vector<Edge>& edges() const { return edges_; }

 private:
  /// The largest r * along_r + z * along_z of the profile.
  double support(double along_r, double along_z) const;

  Vec3 base_, axis_;
  std::vector<Edge> edges_;
  std::string description_;
};

/// The tool of the process: a working face at the base, a land of full radius above it, and a shank whose radius is
/// smaller by `relief` so that it does not rub on the tube. The edge of the face is rounded by `edge_fillet`.
ShapePointer make_tool(const Vec3& base, const Vec3& axis, double radius, double land, double relief, double height,
                       double edge_fillet);

/// A die: a ring whose bore has `inner_radius` at the base and opens along the axis by the half-angle `taper` [rad]
/// (closes when negative). The rim of the bore at the far end is rounded by `edge_fillet`.
ShapePointer make_die(const Vec3& base, const Vec3& axis, double inner_radius, double outer_radius, double height,
                      double taper, double edge_fillet);

}  // namespace stirsph
