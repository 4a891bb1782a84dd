//! The scene as the integrator sees it: shapes, what lies on them, lights, and the camera.

use super::camera::Camera;
use super::light::Light;
use super::material::{BoundMaterial, Material};
use super::mesh::{Mesh, MeshPoint};
use super::ray::{Frame, Hit, Ray, Vector};
use super::rectangles::{LANES, RectangleBlock};
use super::shape::{Rectangle, Sphere};
use super::sheet::{Blend, Sheet};

/// What lies on a shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Surface {
    /// A material, by its number.
    Material(usize),
    /// A flat feather, by its number.
    Sheet(usize),
    /// A light, by its number. It takes in all that falls on it.
    Light(usize),
}

/// A scene that can be rendered.
#[derive(Debug)]
pub struct Scene {
    pub(super) camera: Camera,
    materials: Vec<Material>,
    spheres: Vec<(Sphere, usize)>,
    rectangles: Vec<(Rectangle, usize)>,
    /// The same rectangles, for rays.
    blocks: Vec<RectangleBlock>,
    meshes: Vec<(Mesh, usize)>,
    sheets: Vec<Sheet>,
    pub(super) surfaces: Vec<Surface>,
    pub(super) lights: Vec<Light>,
}

/// Where a ray first meets something.
#[derive(Debug, Clone, Copy)]
enum Met {
    Sphere(usize),
    Rectangle(usize, [f64; 2]),
    Mesh(usize, MeshPoint),
}

impl Scene {
    /// An empty scene with these materials, which its shapes name by number: counted over all shades of all materials, so that
    /// a material's number is that of its first shade.
    pub fn new(camera: Camera, materials: Vec<Material>) -> Self {
        Self {
            camera,
            materials,
            spheres: Vec::new(),
            rectangles: Vec::new(),
            blocks: Vec::new(),
            meshes: Vec::new(),
            sheets: Vec::new(),
            surfaces: Vec::new(),
            lights: Vec::new(),
        }
    }

    /// Adds a material, and says the number of its first shade.
    pub fn add_material(&mut self, material: Material) -> usize {
        let number = self.materials.iter().map(Material::shade_count).sum();
        self.materials.push(material);
        number
    }

    /// Where the camera stands.
    pub fn camera_position(&self) -> Vector {
        self.camera.position()
    }

    /// Puts another material in the place of number `material`.
    pub fn replace_material(&mut self, material: usize, by: Material) {
        self.materials[material] = by;
    }

    /// Adds a sphere of a material.
    #[must_use]
    pub fn with_sphere(mut self, sphere: Sphere, material: usize) -> Self {
        let surface = self.add_surface(Surface::Material(material));
        self.spheres.push((sphere, surface));
        self
    }

    /// Adds a rectangle of a material.
    #[must_use]
    pub fn with_rectangle(mut self, rectangle: Rectangle, material: usize) -> Self {
        let surface = self.add_surface(Surface::Material(material));
        self.add_rectangle(rectangle, surface);
        self
    }

    /// Adds a mesh of a material.
    #[must_use]
    pub fn with_mesh(mut self, mesh: Mesh, material: usize) -> Self {
        let surface = self.add_surface(Surface::Material(material));
        self.meshes.push((mesh, surface));
        self
    }

    /// Adds a flat feather.
    #[must_use]
    pub fn with_sheet(mut self, sheet: Sheet) -> Self {
        let surface = self.add_surface(Surface::Sheet(self.sheets.len()));
        self.add_rectangle(sheet.rectangle, surface);
        self.sheets.push(sheet);
        self
    }

    /// Adds a light, and its shape where it has one.
    #[must_use]
    pub fn with_light(mut self, light: Light) -> Self {
        let number = self.lights.len();
        match &light {
            Light::Rectangle { shape, .. } => {
                let surface = self.add_surface(Surface::Light(number));
                self.add_rectangle(*shape, surface);
            }
            Light::Sphere { shape, .. } => {
                let surface = self.add_surface(Surface::Light(number));
                self.spheres.push((*shape, surface));
            }
            Light::Point { .. } | Light::Directional { .. } | Light::Constant { .. } | Light::Map(_) => {}
        }
        self.lights.push(light);
        self
    }

    fn add_rectangle(&mut self, rectangle: Rectangle, surface: usize) {
        let lane = self.rectangles.len() % LANES;
        if lane == 0 {
            self.blocks.push(RectangleBlock::default());
        }
        if let Some(block) = self.blocks.last_mut() {
            block.set(lane, &rectangle);
        }
        self.rectangles.push((rectangle, surface));
    }

    fn add_surface(&mut self, surface: Surface) -> usize {
        if let Surface::Material(material) = surface {
            let count: usize = self.materials.iter().map(Material::shade_count).sum();
            assert!(material < count, "there is no material number {material}");
        }
        self.surfaces.push(surface);
        self.surfaces.len() - 1
    }

    pub(super) fn bind_materials(&self) -> Vec<BoundMaterial<'_>> {
        self.materials.iter().flat_map(Material::bind).collect()
    }

    /// Radius of a sphere about the centre of its bounds that holds all shapes, mm; 1 without any.
    pub(super) fn radius(&self) -> f64 {
        let mut low = Vector::repeat(f64::INFINITY);
        let mut high = -low;
        let mut grow = |points: &[Vector]| {
            for point in points {
                (low, high) = (low.inf(point), high.sup(point));
            }
        };
        for (sphere, _) in &self.spheres {
            grow(&[sphere.centre.add_scalar(-sphere.radius), sphere.centre.add_scalar(sphere.radius)]);
        }
        for (rectangle, _) in &self.rectangles {
            grow(&rectangle.corners());
        }
        for (mesh, _) in &self.meshes {
            grow(&mesh.bounds());
        }
        let radius = 0.5 * (high - low).norm();
        if radius.is_finite() { radius } else { 1.0 }
    }

    /// The first thing that the ray meets beyond `nearest`.
    #[inline(always)]
    pub(super) fn first_hit(&self, ray: &Ray, nearest: f64) -> Option<Hit> {
        let (mut farthest, mut met) = (f64::INFINITY, None);
        for (block, first) in self.blocks.iter().zip((0..).step_by(LANES)) {
            let hits = block.meet(ray, nearest, farthest);
            let mut best = None;
            for (lane, distance) in hits.distance.into_iter().enumerate() {
                if distance < farthest {
                    (farthest, best) = (distance, Some(lane));
                }
            }
            if let Some(lane) = best {
                met = Some(Met::Rectangle(first + lane, hits.place(lane)));
            }
        }
        for (number, (sphere, _)) in self.spheres.iter().enumerate() {
            if let Some(distance) = sphere.distance(ray, nearest, farthest) {
                (farthest, met) = (distance, Some(Met::Sphere(number)));
            }
        }
        for (number, (mesh, _)) in self.meshes.iter().enumerate() {
            if let Some(point) = mesh.nearest(ray, nearest, farthest) {
                (farthest, met) = (point.distance, Some(Met::Mesh(number, point)));
            }
        }
        Some(match met? {
            Met::Rectangle(number, uv) => {
                let (rectangle, surface) = &self.rectangles[number];
                rectangle.hit(farthest, uv, *surface)
            }
            Met::Sphere(number) => {
                let (sphere, surface) = &self.spheres[number];
                sphere.hit(ray, farthest, *surface)
            }
            Met::Mesh(number, point) => {
                let (mesh, surface) = &self.meshes[number];
                mesh.hit(ray, point, *surface)
            }
        })
    }

    /// Share of light that passes along a ray between two distances: 0 behind anything, except where a material lets
    /// light straight through.
    #[inline(always)]
    pub(super) fn passed(&self, materials: &[BoundMaterial<'_>], ray: &Ray, nearest: f64, farthest: f64) -> f64 {
        let mut share = 1.0;
        for (block, rectangles) in self.blocks.iter().zip(self.rectangles.chunks(LANES)) {
            let hits = block.meet(ray, nearest, farthest);
            // Most rays towards a light meet nothing.
            if hits.distance.iter().all(|distance| *distance == f64::INFINITY) {
                continue;
            }
            for (lane, (rectangle, surface)) in rectangles.iter().enumerate() {
                let distance = hits.distance[lane];
                if distance < f64::INFINITY {
                    let hit = || rectangle.hit(distance, hits.place(lane), *surface);
                    share *= self.share_through(materials, *surface, ray, hit);
                    if share == 0.0 {
                        return 0.0;
                    }
                }
            }
        }
        for (sphere, surface) in &self.spheres {
            // Both sides of it.
            let mut from = nearest;
            while let Some(distance) = sphere.distance(ray, from, farthest) {
                share *= self.share_through(materials, *surface, ray, || sphere.hit(ray, distance, *surface));
                if share == 0.0 {
                    return 0.0;
                }
                from = distance;
            }
        }
        for (mesh, surface) in &self.meshes {
            mesh.each(ray, nearest, farthest, |point| {
                share *= self.share_through(materials, *surface, ray, || mesh.hit(ray, point, *surface));
                share > 0.0
            });
            if share == 0.0 {
                return 0.0;
            }
        }
        share
    }

    /// What the ray met first: a light, a material with its tangent, or an open part of a sheet.
    #[inline]
    pub(super) fn meaning(&self, hit: &mut Hit) -> Meaning {
        match self.surfaces[hit.surface] {
            Surface::Light(light) => Meaning::Light(light),
            Surface::Material(material) => Meaning::Material { blend: Blend::pure(material), coverage: 1.0 },
            Surface::Sheet(sheet) => match self.sheets[sheet].at(hit) {
                Some(point) => {
                    hit.tangent = point.tangent;
                    Meaning::Material { blend: point.blend, coverage: point.coverage }
                }
                None => Meaning::Nothing,
            },
        }
    }

    #[inline]
    fn share_through(
        &self,
        materials: &[BoundMaterial<'_>],
        surface: usize,
        ray: &Ray,
        hit: impl FnOnce() -> Hit,
    ) -> f64 {
        match self.surfaces[surface] {
            Surface::Light(_) => return 0.0,
            Surface::Material(material) if !materials[material].passes => return 0.0,
            Surface::Material(_) | Surface::Sheet(_) => {}
        }
        let mut hit = hit();
        match self.meaning(&mut hit) {
            Meaning::Light(_) => 0.0,
            Meaning::Nothing => 1.0,
            Meaning::Material { blend, coverage } => {
                let frame = Frame::new(hit.normal, hit.tangent);
                let direction = frame.to_local(&ray.direction);
                let open = |(material, share): (usize, f64)| {
                    if share > 0.0 { share * materials[material].bsdf.straight_through(&direction) } else { 0.0 }
                };
                let open: f64 = blend.parts().map(open).sum();
                1.0 - coverage * (1.0 - open)
            }
        }
    }
}

/// What lies at the point where a ray met a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Meaning {
    /// A light, by its number.
    Light(usize),
    /// A material or two that cover this share of the point; the rest is open.
    Material { blend: Blend, coverage: f64 },
    /// Nothing.
    Nothing,
}
