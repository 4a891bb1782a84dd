//! The light that reaches the camera, by Monte Carlo: paths from the camera, at each surface a direction towards a light
//! and one of the surface's own choosing, weighed against each other by the balance heuristic (Veach 1997, chapter 9).
//!
//! Many paths go step by step together. All of them meet their next surface; those that met the same material are shaded
//! in one call of its model, which then runs over contiguous lanes; nothing is allocated in between.
//!
//! - A light is chosen in proportion to the power that it sends into the scene. One that shines alike from everywhere is
//!   never chosen: directions that a surface draws itself suit it best.
//! - What goes straight through a surface (the open share of a vane) is neither a bounce nor a shadow: a path goes on, and a
//!   ray towards a light is dimmed.
//! - From the fourth scattering on a path goes on with the probability of its largest channel, at most 0.95, and counts so
//!   much more.

use super::light::Light;
use super::material::{BoundMaterial, CHANNELS};
use super::ray::{Colour, Frame, Hit, Ray, Vector};
use super::sampler::{PixelSeed, SampleNumbers, Sampler};
use super::scene::{Meaning, Scene};
use super::sheet::Blend;
use crate::bsdf::{Direction, Sample};

/// Scatterings before a path may end by chance.
const SURE_SCATTERINGS: u32 = 3;

/// Surfaces that a path may go straight through or scatter at. Beyond it nothing is worth counting: with half of the light
/// passing each vane, the largest share there is, 2⁻²⁵⁶ is left.
const MOST_EVENTS: u32 = 256;

/// Rays start beyond this share of the scene's radius, so that they do not meet the surface that they leave; rounding is
/// a hundred-thousandth of it.
const START: f64 = 1e-10;

/// Which directions are drawn at a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Strategies {
    /// Towards a light and by the surface, weighed against each other.
    #[default]
    Both,
    /// Towards a light alone. Light that is met by the surface's own direction is not counted.
    Light,
    /// By the surface alone; sources without size are still drawn, since nothing else finds them.
    Surface,
}

/// How light is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Scatterings between light and camera at most: 1 is direct light only.
    pub scatterings: u32,
    /// Which directions are drawn.
    pub strategies: Strategies,
    /// How samples are spread.
    pub sampler: Sampler,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// A path on its way from the camera.
#[derive(Debug, Clone, Copy)]
struct Path {
    ray: Ray,
    /// Nothing nearer than this on the ray is met.
    nearest: f64,
    throughput: Colour,
    /// Density of the surface's draw, 1/sr; None for the camera's rays.
    density: Option<f64>,
    /// Scatterings so far.
    scatterings: u32,
    /// Surfaces met so far.
    events: u32,
    /// Place in the tile's sums.
    pixel: usize,
    seed: PixelSeed,
    /// Numbers of the first event that the camera's group has left.
    spare: [f64; 2],
}

impl Path {
    /// The numbers of the event that it has come to: one group of four dimensions and a part of a second. At the first
    /// event that part is what the camera has left, since no path ends there by chance.
    #[inline(always)]
    fn numbers(&self, sample: &SampleNumbers) -> EventNumbers {
        let [u, v, a, b] = sample.four(self.seed, 2 * self.events - 1);
        let [c, choose, chance] = match self.events {
            1 => [self.spare[0], self.spare[1], 0.0],
            _ => {
                let [c, choose, chance, _] = sample.four(self.seed, 2 * self.events);
                [c, choose, chance]
            }
        };
        EventNumbers { choose, light: [u, v], surface: [a, b, c], chance }
    }
}

/// A point where a path has met a material.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    path: usize,
    distance: f64,
    point: Vector,
    frame: Frame,
    geometric_normal: Vector,
    outgoing: Direction,
    texel: Colour,
    numbers: EventNumbers,
}

/// The random numbers of one event on a path.
#[derive(Debug, Clone, Copy)]
struct EventNumbers {
    /// Which light, and where on it.
    choose: f64,
    light: [f64; 2],
    /// For the surface's own draw.
    surface: [f64; 3],
    /// Whether the path goes on.
    chance: f64,
}

/// A direction that is to be evaluated at a vertex.
#[derive(Debug, Clone, Copy)]
struct Task {
    vertex: usize,
    direction: Vector,
    /// Towards a light: what an evaluation is multiplied by, before the weight of the strategy.
    weight: Colour,
    /// Density of the draw, 1/sr; None from a source without size.
    density: Option<f64>,
}

/// Follows paths through a scene.
pub(super) struct Integrator<'a> {
    scene: &'a Scene,
    materials: Vec<BoundMaterial<'a>>,
    settings: Settings,
    /// Probability of each light's choice, and its sums.
    choice: Vec<(f64, f64)>,
    /// The light that surrounds the scene, with the probability of its choice.
    environment: Option<(&'a Light, f64)>,
    start: f64,
    /// Whether a direction drawn by a surface can find light.
    has_size: bool,
}

/// Memory of one batch of paths, used again for the next.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    paths: Vec<Path>,
    vertices: Vec<Vec<Vertex>>,
    tasks: Vec<Task>,
    incoming: Vec<Direction>,
    outgoing: Vec<Direction>,
    random: Vec<[f64; 3]>,
    drawn: Vec<Option<Sample>>,
    values: Vec<f64>,
    densities: Vec<f64>,
    alive: Vec<bool>,
}

/// The pixels of a tile: `x` and `y` from the picture's upper left corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Tile {
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) width: u32,
    pub(super) height: u32,
}

impl<'a> Integrator<'a> {
    pub(super) fn new(scene: &'a Scene, settings: Settings) -> Self {
        let radius = scene.radius();
        let worth = |light: &Light| match settings.strategies {
            Strategies::Both if light.is_constant() => 0.0,
            Strategies::Surface if !light.is_without_size() => 0.0,
            _ => light.power(radius),
        };
        let worths: Vec<f64> = scene.lights.iter().map(worth).collect();
        let total: f64 = worths.iter().sum();
        let mut sum = 0.0;
        let choice = worths.iter().map(|worth| {
            let probability = if total > 0.0 { worth / total } else { 0.0 };
            sum += probability;
            (probability, sum)
        });
        let choice: Vec<(f64, f64)> = choice.collect();
        let environment = scene.lights.iter().zip(&choice).find(|(light, _)| light.is_environment());
        Self {
            scene,
            materials: scene.bind_materials(),
            settings,
            environment: environment.map(|(light, (probability, _))| (light, *probability)),
            choice,
            start: START * radius.max(scene.camera.position().norm()),
            has_size: scene.lights.iter().any(|light| !light.is_without_size()),
        }
    }

    /// Adds one sample of each pixel of a tile to its sums, row by row.
    #[inline(always)]
    pub(super) fn add_sample(
        &self,
        size: [u32; 2],
        tile: &Tile,
        index: u32,
        workspace: &mut Workspace,
        sums: &mut [Colour],
    ) {
        let sample = SampleNumbers::new(self.settings.sampler, self.settings.seed, index);
        self.start_paths(&sample, size, tile, &mut workspace.paths);
        workspace.vertices.resize_with(self.materials.len(), Vec::new);
        while !workspace.paths.is_empty() {
            self.meet(&sample, workspace, sums);
            for number in 0..self.materials.len() {
                // Taken out, so that the rest of the workspace is free while it is read.
                let vertices = std::mem::take(&mut workspace.vertices[number]);
                if !vertices.is_empty() {
                    self.draw_lights(number, &vertices, workspace, sums);
                    self.draw_directions(number, &vertices, workspace);
                }
                workspace.vertices[number] = vertices;
            }
            let mut alive = workspace.alive.iter();
            workspace.paths.retain(|_| alive.next().copied().unwrap_or(false));
        }
    }

    #[inline(always)]
    fn start_paths(&self, sample: &SampleNumbers, [width, height]: [u32; 2], tile: &Tile, paths: &mut Vec<Path>) {
        paths.clear();
        let pixel_size = 1.0 / f64::from(height);
        let middle = 0.5 * f64::from(width);
        for row in 0..tile.height {
            for column in 0..tile.width {
                let (x, y) = (tile.x + column, tile.y + row);
                let pixel = u64::from(y) * u64::from(width) + u64::from(x);
                let seed = sample.pixel(pixel);
                let [right, down, spare @ ..] = sample.four(seed, 0);
                let place_x = (f64::from(x) + right - middle) * pixel_size;
                let place_y = 0.5 - (f64::from(y) + down) * pixel_size;
                paths.push(Path {
                    ray: self.scene.camera.ray(place_x, place_y),
                    nearest: 0.0,
                    throughput: [1.0; 3],
                    density: None,
                    scatterings: 0,
                    events: 0,
                    pixel: (row * tile.width + column) as usize,
                    seed,
                    spare,
                });
            }
        }
    }

    /// Sends each path to its next surface: it ends in light or in the dark, or waits at a material.
    #[inline(always)]
    fn meet(&self, sample: &SampleNumbers, workspace: &mut Workspace, sums: &mut [Colour]) {
        for vertices in &mut workspace.vertices {
            vertices.clear();
        }
        workspace.alive.clear();
        workspace.alive.resize(workspace.paths.len(), false);
        for (number, path) in workspace.paths.iter_mut().enumerate() {
            while path.events < MOST_EVENTS {
                path.events += 1;
                let Some(mut hit) = self.scene.first_hit(&path.ray, path.nearest) else {
                    if let Some((light, choice)) = self.environment {
                        self.add_light_met(light, choice, path, f64::INFINITY, &mut sums[path.pixel]);
                    }
                    break;
                };
                match self.scene.meaning(&mut hit) {
                    Meaning::Light(light) => {
                        let (choice, light) = (self.choice[light].0, &self.scene.lights[light]);
                        self.add_light_met(light, choice, path, hit.distance, &mut sums[path.pixel]);
                        break;
                    }
                    Meaning::Material { blend, coverage } => match covering(sample, path, &blend, coverage) {
                        Some(material) => {
                            // A path that has scattered often enough may still go straight on.
                            if !self.is_spent(path) || self.materials[material].passes {
                                let vertex = self.vertex(sample, number, path, &hit, material);
                                workspace.vertices[material].push(vertex);
                            }
                            break;
                        }
                        // Through an open part, which is neither a bounce nor a shadow.
                        None => path.nearest = hit.distance + self.start,
                    },
                    Meaning::Nothing => path.nearest = hit.distance + self.start,
                }
            }
        }
    }

    /// Whether a path has scattered as often as it may.
    fn is_spent(&self, path: &Path) -> bool {
        path.scatterings == self.settings.scatterings
    }

    #[inline(always)]
    fn vertex(&self, sample: &SampleNumbers, number: usize, path: &Path, hit: &Hit, material: usize) -> Vertex {
        let frame = Frame::new(hit.normal, hit.tangent);
        Vertex {
            path: number,
            distance: hit.distance,
            point: hit.point,
            frame,
            geometric_normal: hit.geometric_normal,
            outgoing: frame.to_local(&-path.ray.direction),
            texel: self.materials[material].texel(hit.uv),
            numbers: path.numbers(sample),
        }
    }

    /// Counts light that a path has run into.
    #[inline]
    fn add_light_met(&self, light: &Light, choice: f64, path: &Path, distance: f64, sum: &mut Colour) {
        let weight = match (path.density, self.settings.strategies) {
            // The camera's rays draw no lights.
            (None, _) | (_, Strategies::Surface) => 1.0,
            (Some(_), Strategies::Light) => 0.0,
            (Some(_), Strategies::Both) if choice == 0.0 => 1.0,
            (Some(density), Strategies::Both) => {
                let other = choice * light.density(&path.ray.origin, &path.ray.direction, distance);
                density / (density + other)
            }
        };
        if weight > 0.0 {
            add(sum, &path.throughput, &light.radiance(&path.ray.direction), weight);
        }
    }

    /// Draws a direction towards a light from each vertex of a material, and counts what comes from there.
    #[inline(always)]
    fn draw_lights(&self, material: usize, vertices: &[Vertex], workspace: &mut Workspace, sums: &mut [Colour]) {
        let last_choice = self.choice.last().map_or(0.0, |(_, sum)| *sum);
        if last_choice == 0.0 {
            return;
        }
        let Workspace { paths, tasks, incoming, outgoing, values, densities, .. } = workspace;
        tasks.clear();
        incoming.clear();
        outgoing.clear();
        for (number, vertex) in vertices.iter().enumerate() {
            let path = &paths[vertex.path];
            if self.is_spent(path) {
                continue;
            }
            let EventNumbers { choose, light: place, .. } = vertex.numbers;
            let light = self.choice.iter().position(|(_, sum)| choose * last_choice < *sum).unwrap_or(0);
            let choice = self.choice[light].0;
            let Some(sample) = self.scene.lights[light].sample(&vertex.point, place) else { continue };
            let local = vertex.frame.to_local(&sample.direction);
            if !same_side(vertex, &sample.direction, &local) {
                continue;
            }
            let ray = Ray { origin: vertex.point, direction: sample.direction };
            let end = sample.distance * (1.0 - START) - self.start;
            let passed = self.scene.passed(&self.materials, &ray, self.start, end);
            if passed > 0.0 {
                let scale = passed * local.z.abs() / choice;
                let weight = sample.weight.map(|channel| channel * scale);
                let density = sample.density.map(|density| density * choice);
                tasks.push(Task { vertex: number, direction: sample.direction, weight, density });
                incoming.push(local);
                outgoing.push(vertex.outgoing);
            }
        }

        let bound = &self.materials[material];
        evaluate(bound, incoming, outgoing, values);
        densities.clear();
        densities.resize(tasks.len(), 0.0);
        if self.settings.strategies == Strategies::Both {
            bound.bsdf.density_many(incoming, outgoing, densities);
        }
        for (number, task) in tasks.iter().enumerate() {
            let vertex = &vertices[task.vertex];
            let path = &paths[vertex.path];
            let function = bound.mix(&values[number * bound.channels..][..bound.channels], &vertex.texel);
            let share = match (task.density, self.settings.strategies) {
                (Some(density), Strategies::Both) => density / (density + densities[number]),
                _ => 1.0,
            };
            let arriving = std::array::from_fn(|k| function[k] * task.weight[k]);
            add(&mut sums[path.pixel], &path.throughput, &arriving, share);
        }
    }

    /// Draws from each vertex of a material the direction in which its path goes on.
    #[inline(always)]
    fn draw_directions(&self, material: usize, vertices: &[Vertex], workspace: &mut Workspace) {
        let bound = &self.materials[material];
        let Workspace { paths, tasks, incoming, outgoing, random, drawn, values, alive, .. } = workspace;
        outgoing.clear();
        random.clear();
        for vertex in vertices {
            outgoing.push(vertex.outgoing);
            random.push(vertex.numbers.surface);
        }
        drawn.clear();
        drawn.resize(vertices.len(), None);
        bound.bsdf.sample_many(outgoing, random, drawn);

        tasks.clear();
        incoming.clear();
        outgoing.clear();
        for (number, (vertex, drawn)) in vertices.iter().zip(drawn).enumerate() {
            let path = &mut paths[vertex.path];
            let is_last = path.scatterings + 1 == self.settings.scatterings;
            if path.events == MOST_EVENTS || (is_last && !self.has_size && !bound.passes) {
                continue;
            }
            let Some(sample) = drawn else { continue };
            if sample.straight_through {
                path.nearest = vertex.distance + self.start;
                alive[vertex.path] = true;
                continue;
            }
            if self.is_spent(path) {
                continue;
            }
            let direction = vertex.frame.to_scene(&sample.incoming);
            if same_side(vertex, &direction, &sample.incoming) {
                tasks.push(Task { vertex: number, direction, weight: [0.0; 3], density: Some(sample.density) });
                incoming.push(sample.incoming);
                outgoing.push(vertex.outgoing);
            }
        }

        evaluate(bound, incoming, outgoing, values);
        for (number, task) in tasks.iter().enumerate() {
            let vertex = &vertices[task.vertex];
            let path = &mut paths[vertex.path];
            let Some(density) = task.density else { continue };
            let function = bound.mix(&values[number * bound.channels..][..bound.channels], &vertex.texel);
            let scale = incoming[number].z.abs() / density;
            path.throughput = std::array::from_fn(|k| path.throughput[k] * function[k] * scale);
            path.scatterings += 1;
            let largest = path.throughput.iter().fold(0.0, |largest: f64, channel| largest.max(*channel));
            if largest == 0.0 {
                continue;
            }
            if path.scatterings > SURE_SCATTERINGS {
                let survival = largest.min(0.95);
                if vertex.numbers.chance >= survival {
                    continue;
                }
                path.throughput = path.throughput.map(|channel| channel / survival);
            }
            path.ray = Ray { origin: vertex.point, direction: task.direction };
            path.nearest = self.start;
            path.density = Some(density);
            alive[vertex.path] = true;
        }
    }
}

/// The material that a path meets where a blend covers this share of a point; None where it goes through.
#[inline]
fn covering(sample: &SampleNumbers, path: &Path, blend: &Blend, coverage: f64) -> Option<usize> {
    if coverage >= 1.0
        && let Some(material) = blend.only()
    {
        return Some(material);
    }
    // One number decides both: below the coverage it is uniform again.
    let random = sample.four(path.seed, 2 * path.events)[3];
    (random < coverage).then(|| blend.chosen(random / coverage))
}

/// Whether a direction lies on the same side of the interpolated surface as of the true one: else light would leak
/// through a mesh along its rim.
#[inline]
fn same_side(vertex: &Vertex, direction: &Vector, local: &Direction) -> bool {
    vertex.geometric_normal.dot(direction) * local.z > 0.0
}

/// Evaluates a material for pairs of directions into `values`.
fn evaluate(bound: &BoundMaterial<'_>, incoming: &[Direction], outgoing: &[Direction], values: &mut Vec<f64>) {
    values.clear();
    values.resize(incoming.len() * bound.channels, 0.0);
    if !incoming.is_empty() {
        bound.bsdf.evaluate_many(incoming, outgoing, values);
    }
}

#[inline]
fn add(sum: &mut Colour, throughput: &Colour, radiance: &Colour, weight: f64) {
    for k in 0..CHANNELS {
        sum[k] += throughput[k] * radiance[k] * weight;
    }
}
