//! Triangle meshes: the `bvh` crate's hierarchy (surface-area heuristic) of the triangles' boxes, and a walk through it
//! that asks for no memory and passes by what lies behind the nearest triangle met so far.

use std::collections::BTreeMap;

use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::{Bvh, BvhNode};
use nalgebra::Point3;

use super::ray::{Hit, Ray, Vector, any_tangent};

/// Levels that a walk can hold. The heuristic halves what it cannot part, so that 2⁶⁴ triangles would not fill them.
const DEPTH: usize = 128;

/// Corners of a triangle with what belongs to each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Place.
    pub position: Vector,
    /// Unit normal, where the mesh has them.
    pub normal: Option<Vector>,
    /// Place in textures, where the mesh has it.
    pub uv: Option<[f64; 2]>,
}

/// Three corners, anticlockwise as seen from outside.
#[derive(Debug, Clone)]
struct Triangle {
    corners: [Corner; 3],
    edges: [Vector; 2],
    node: usize,
}

impl Bounded<f64, 3> for Triangle {
    fn aabb(&self) -> Aabb<f64, 3> {
        let mut bounds = Aabb::empty();
        for corner in &self.corners {
            bounds.grow_mut(&Point3::from(corner.position));
        }
        bounds
    }
}

impl BHShape<f64, 3> for Triangle {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

impl Triangle {
    /// Distance and the weights of the second and third corner (Möller and Trumbore 1997), from either side.
    #[inline]
    fn meet(&self, ray: &Ray, nearest: f64, farthest: f64) -> Option<(f64, [f64; 2])> {
        let p = ray.direction.cross(&self.edges[1]);
        let inverse = 1.0 / self.edges[0].dot(&p);
        let from_first = ray.origin - self.corners[0].position;
        let u = from_first.dot(&p) * inverse;
        // A ray along the plane gives infinities or no numbers, which pass no comparison.
        if !(0.0..=1.0).contains(&u) {
            return None;
        }
        let q = from_first.cross(&self.edges[0]);
        let v = ray.direction.dot(&q) * inverse;
        if !(v >= 0.0 && u + v <= 1.0) {
            return None;
        }
        let distance = self.edges[1].dot(&q) * inverse;
        (distance > nearest && distance < farthest).then_some((distance, [u, v]))
    }
}

/// A mesh of triangles.
#[derive(Debug)]
pub struct Mesh {
    triangles: Vec<Triangle>,
    hierarchy: Bvh<f64, 3>,
}

/// Where a ray meets a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshPoint {
    /// mm.
    pub distance: f64,
    triangle: usize,
    weights: [f64; 2],
}

impl Mesh {
    /// A mesh of at least one triangle.
    ///
    /// # Errors
    /// The number, from 0, of a triangle without an area.
    pub fn new(triangles: Vec<[Corner; 3]>) -> Result<Self, usize> {
        let mut made = Vec::with_capacity(triangles.len());
        for (number, corners) in triangles.into_iter().enumerate() {
            let [a, b, c] = corners.map(|corner| corner.position);
            let edges = [b - a, c - a];
            // Below this the normal is rounding: twice the area over the squared longest edge, of numbers of 16 digits.
            let area = edges[0].cross(&edges[1]).norm();
            let longest = edges[0].norm_squared().max(edges[1].norm_squared());
            // What is no number has none either.
            let has_area = area > 1e-12 * longest;
            if !has_area {
                return Err(number);
            }
            made.push(Triangle { corners, edges, node: 0 });
        }
        let hierarchy = Bvh::build(&mut made);
        Ok(Self { triangles: made, hierarchy })
    }

    /// The nearest point of the ray on it between two distances.
    pub fn nearest(&self, ray: &Ray, nearest: f64, farthest: f64) -> Option<MeshPoint> {
        let mut best = None;
        let mut farthest = farthest;
        self.walk(ray, farthest, &mut |number, reach| {
            if let Some((distance, weights)) = self.triangles[number].meet(ray, nearest, farthest) {
                farthest = distance;
                *reach = distance;
                best = Some(MeshPoint { distance, triangle: number, weights });
            }
            true
        });
        best
    }

    /// Every point of the ray on it between two distances, in any order, until `visit` says false.
    pub fn each(&self, ray: &Ray, nearest: f64, farthest: f64, mut visit: impl FnMut(MeshPoint) -> bool) {
        self.walk(ray, farthest, &mut |number, _| match self.triangles[number].meet(ray, nearest, farthest) {
            Some((distance, weights)) => visit(MeshPoint { distance, triangle: number, weights }),
            None => true,
        });
    }

    /// Visits the triangles whose boxes the ray enters within `reach`, which a visit may shorten, near ones first, until
    /// one says false.
    fn walk(&self, ray: &Ray, mut reach: f64, visit: &mut impl FnMut(usize, &mut f64) -> bool) {
        let nodes = &self.hierarchy.nodes;
        let query = bvh::ray::Ray {
            origin: Point3::from(ray.origin),
            direction: ray.direction,
            inv_direction: ray.direction.map(|x| 1.0 / x),
        };
        let mut stack = [(0usize, 0f64); DEPTH];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (index, entry) = stack[height];
            if entry > reach {
                continue;
            }
            match &nodes[index] {
                BvhNode::Leaf { shape_index, .. } => {
                    if !visit(*shape_index, &mut reach) {
                        return;
                    }
                }
                BvhNode::Node { child_l_index, child_l_aabb, child_r_index, child_r_aabb, .. } => {
                    let left = entry_of(&query, child_l_aabb).map(|entry| (*child_l_index, entry));
                    let right = entry_of(&query, child_r_aabb).map(|entry| (*child_r_index, entry));
                    let (near, far) = match (left, right) {
                        (Some(l), Some(r)) if r.1 < l.1 => (Some(r), Some(l)),
                        (l, r) => (l, r),
                    };
                    for child in [far, near].into_iter().flatten() {
                        stack[height] = child;
                        height += 1;
                    }
                }
            }
        }
    }

    /// What a ray meets at this point.
    pub fn hit(&self, ray: &Ray, point: MeshPoint, surface: usize) -> Hit {
        let triangle = &self.triangles[point.triangle];
        let [u, v] = point.weights;
        let weights = [1.0 - u - v, u, v];
        let geometric_normal = triangle.edges[0].cross(&triangle.edges[1]).normalize();
        let [a, b, c] = &triangle.corners;
        let normal = match (a.normal, b.normal, c.normal) {
            (Some(a), Some(b), Some(c)) => {
                (a * weights[0] + b * weights[1] + c * weights[2]).try_normalize(1e-9).unwrap_or(geometric_normal)
            }
            _ => geometric_normal,
        };
        let (uv, along_u) = match (a.uv, b.uv, c.uv) {
            (Some(a), Some(b), Some(c)) => {
                let place = std::array::from_fn(|k| a[k] * weights[0] + b[k] * weights[1] + c[k] * weights[2]);
                (place, direction_of_u(&triangle.edges, [a, b, c]))
            }
            _ => (point.weights, None),
        };
        let flat = |tangent: Vector| (tangent - normal * normal.dot(&tangent)).try_normalize(1e-9);
        let tangent = along_u.and_then(flat).unwrap_or_else(|| any_tangent(&normal));
        Hit { distance: point.distance, point: ray.at(point.distance), normal, geometric_normal, tangent, uv, surface }
    }

    /// Whether every edge is shared by two triangles, so that the mesh has an inside.
    pub fn is_closed(&self) -> bool {
        let mut edges: BTreeMap<[[u64; 3]; 2], u32> = BTreeMap::new();
        for triangle in &self.triangles {
            let corners = triangle.corners.map(|corner| [0, 1, 2].map(|k| (corner.position[k] + 0.0).to_bits()));
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                *edges.entry(if a < b { [a, b] } else { [b, a] }).or_default() += 1;
            }
        }
        edges.values().all(|count| *count == 2)
    }

    /// Whether a point is inside a closed mesh: a ray from it leaves once more than it enters.
    pub fn contains(&self, point: &Vector) -> bool {
        // A direction that lies along no axis, edge or diagonal of a mesh made by hand.
        let ray = Ray { origin: *point, direction: Vector::new(0.309_3, 0.732_1, 0.606_9).normalize() };
        let mut crossings = 0u32;
        self.each(&ray, 0.0, f64::INFINITY, |_| {
            crossings += 1;
            true
        });
        crossings % 2 == 1
    }

    /// Its smallest and largest coordinates.
    pub fn bounds(&self) -> [Vector; 2] {
        let corners = self.triangles.iter().flat_map(|triangle| triangle.corners);
        corners.fold([Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY)], |[low, high], corner| {
            [low.inf(&corner.position), high.sup(&corner.position)]
        })
    }
}

/// Distance at which a ray enters a box, 0 from inside.
#[inline]
fn entry_of(ray: &bvh::ray::Ray<f64, 3>, bounds: &Aabb<f64, 3>) -> Option<f64> {
    let (mut entry, mut exit) = (0f64, f64::INFINITY);
    for axis in 0..3 {
        let a = (bounds.min[axis] - ray.origin[axis]) * ray.inv_direction[axis];
        let b = (bounds.max[axis] - ray.origin[axis]) * ray.inv_direction[axis];
        // f64's min and max pass over what is no number: a ray inside the plane of a face still meets the box, so that no
        // flat mesh is missed.
        entry = entry.max(a.min(b));
        exit = exit.min(a.max(b));
    }
    // One rounding each way must not lose a triangle on the face of its box.
    (entry <= exit * (1.0 + 4.0 * f64::EPSILON)).then_some(entry)
}

/// Where u grows along a triangle, of any length; None where the texture is not laid out over it.
fn direction_of_u(edges: &[Vector; 2], [a, b, c]: [[f64; 2]; 3]) -> Option<Vector> {
    let [(du1, dv1), (du2, dv2)] = [b, c].map(|uv| (uv[0] - a[0], uv[1] - a[1]));
    let determinant = du1 * dv2 - du2 * dv1;
    ((edges[0] * dv2 - edges[1] * dv1) / determinant).try_normalize(0.0).filter(|t| t.iter().all(|x| x.is_finite()))
}
