//! Shares of a function's variance that its inputs cause: Sobol indices with their own errors.
//!
//! The inputs vary independently over the unit cube. The *first-order* index of an input is the share of the variance that
//! would vanish if it alone were known; the *total* index is the share that would remain if all the others were known.
//! Their difference is what it does in concert with others.
//!
//! ```text
//! first order  V_i = ⟨f(B) (f(A_Bⁱ) − f(A))⟩           Saltelli et al. 2010, Computer Physics Communications 181:259, Table 2b
//! total        T_i = ½ ⟨(f(A) − f(A_Bⁱ))²⟩              Jansen 1999, Computer Physics Communications 117:35
//! ```
//!
//! A and B are the two halves of a point of twice as many dimensions, and `A_Bⁱ` is A with coordinate i of B. f is taken from
//! its mean first, which leaves `V_i` what it is and its error smaller. Points come from Sobol's sequence with nested uniform
//! scrambling (Burley 2020, Journal of Computer Graphics Techniques 9(4):1). The sequence is repeated under independent
//! scrambles; each index is the ratio of means over all of them, and its standard error is the jackknife's, leaving out one
//! scramble at a time. Indices of several outputs together are `Σ V_i / Σ V` over the outputs (Lamboni et al. 2011,
//! Reliability Engineering & System Safety 96:450).

use std::ops::Range;

use rayon::prelude::*;

/// How an estimate is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SobolSettings {
    /// Points in each scrambled sequence: a power of two, at most 65,536.
    pub samples: u32,
    /// Scrambled sequences, at least 2; their spread gives the errors.
    pub replicates: u32,
    /// Seed of the scrambles.
    pub seed: u64,
}

/// A number and its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// What one input does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Indices {
    /// Share of the variance that it causes alone.
    pub first_order: Estimate,
    /// Share that it causes alone and in concert with others.
    pub total: Estimate,
}

/// What all inputs do to one group of outputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Shares {
    /// Mean over the cube, of the outputs' mean.
    pub mean: f64,
    /// Root of the variance over the cube, of the outputs' mean variance.
    pub standard_deviation: f64,
    /// One an input; none where the outputs do not vary.
    pub indices: Option<Vec<Indices>>,
}

/// Dimensions and points of the sequence; beyond its dimensions another scramble begins.
const SEQUENCE_DIMENSIONS: u32 = 256;
/// Points that are summed in one go; sums are added in their order, so that threads do not change a bit.
const CHUNK: u32 = 64;

/// Indices of `inputs` inputs for each group of outputs.
///
/// `function` takes a point of the unit cube and gives `outputs` finite numbers; a group is a range of them. It is called
/// `replicates · samples · (inputs + 2)` times, from several threads.
///
/// # Errors
/// The first one of the function, in the order of the points.
///
/// # Panics
/// If the settings are not as their fields say, or the function gives another number of outputs: that is the caller's slip.
pub fn sobol_indices<E: Send>(
    inputs: usize,
    outputs: usize,
    groups: &[Range<usize>],
    settings: SobolSettings,
    function: impl Fn(&[f64]) -> Result<Vec<f64>, E> + Sync,
) -> Result<Vec<Shares>, E> {
    let SobolSettings { samples, replicates, .. } = settings;
    assert!(samples.is_power_of_two() && samples <= 1 << 16, "samples are a power of two up to 65536");
    assert!(replicates >= 2, "two replicates at least");
    let origin = function(&vec![0.5; inputs])?;
    assert_eq!(origin.len(), outputs, "the function gives as many outputs as it says");

    let chunks: Vec<(u32, u32)> = (0..replicates)
        .flat_map(|replicate| (0..samples).step_by(CHUNK as usize).map(move |first| (replicate, first)))
        .collect();
    let sums: Vec<Result<(u32, Sums), E>> = chunks
        .into_par_iter()
        .map(|(replicate, first)| {
            let mut sums = Sums::new(inputs, outputs);
            for item in first..(first + CHUNK).min(samples) {
                let point = point(2 * inputs, item, scramble(settings.seed, replicate));
                sums.add(&point, &origin, &function)?;
            }
            Ok((replicate, sums))
        })
        .collect();
    let mut by_replicate = vec![Sums::new(inputs, outputs); replicates as usize];
    for chunk in sums {
        let (replicate, sums) = chunk?;
        by_replicate[replicate as usize].merge(&sums);
    }
    Ok(groups.iter().map(|group| shares(&by_replicate, &origin, group.clone(), f64::from(samples))).collect())
}

/// The seed of one scrambled sequence.
fn scramble(seed: u64, replicate: u32) -> u32 {
    // Both halves of the seed take part; the odd factor spreads neighbouring replicates (Knuth's multiplicative hash).
    let folded = u32::try_from((seed ^ (seed >> 32)) & u64::from(u32::MAX)).unwrap_or(0);
    folded.wrapping_add(replicate.wrapping_mul(0x9E37_79B1))
}

/// One point of the scrambled sequence, in as many dimensions as wanted.
fn point(dimensions: usize, item: u32, seed: u32) -> Vec<f64> {
    (0..u32::try_from(dimensions).unwrap_or(u32::MAX))
        .map(|dimension| {
            let further = (dimension / SEQUENCE_DIMENSIONS).wrapping_mul(0x85EB_CA6B);
            f64::from(sobol_burley::sample(item, dimension % SEQUENCE_DIMENSIONS, seed.wrapping_add(further)))
        })
        .collect()
}

/// Sums over the points of a sequence, for each output; values are counted from `origin`, so that squares keep their digits.
#[derive(Debug, Clone)]
struct Sums {
    /// Σ (f(A) + f(B)) and Σ (f(A)² + f(B)²).
    both: Vec<f64>,
    both_squared: Vec<f64>,
    /// For each input: `Σ f(B) (f(A_Bⁱ) − f(A))`, `Σ (f(A_Bⁱ) − f(A))`, `Σ (f(A_Bⁱ) − f(A))²`.
    product: Vec<Vec<f64>>,
    change: Vec<Vec<f64>>,
    change_squared: Vec<Vec<f64>>,
}

impl Sums {
    fn new(inputs: usize, outputs: usize) -> Self {
        let by_input = || vec![vec![0.0; outputs]; inputs];
        Self {
            both: vec![0.0; outputs],
            both_squared: vec![0.0; outputs],
            product: by_input(),
            change: by_input(),
            change_squared: by_input(),
        }
    }

    /// Adds one point, whose first half is A and whose second is B.
    fn add<E>(
        &mut self,
        point: &[f64],
        origin: &[f64],
        function: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    ) -> Result<(), E> {
        let call = |point: &[f64]| {
            let mut values = function(point)?;
            assert_eq!(values.len(), origin.len(), "the function gives as many outputs everywhere");
            values.iter_mut().zip(origin).for_each(|(value, origin)| *value -= origin);
            Ok(values)
        };
        let (a, b) = point.split_at(point.len() / 2);
        let (at_a, at_b) = (call(a)?, call(b)?);
        for (output, (a, b)) in at_a.iter().zip(&at_b).enumerate() {
            self.both[output] += a + b;
            self.both_squared[output] += a * a + b * b;
        }
        let mut mixed = a.to_vec();
        for input in 0..a.len() {
            mixed[input] = b[input];
            let at_mixed = call(&mixed)?;
            mixed[input] = a[input];
            for output in 0..origin.len() {
                let change = at_mixed[output] - at_a[output];
                self.product[input][output] += at_b[output] * change;
                self.change[input][output] += change;
                self.change_squared[input][output] += change * change;
            }
        }
        Ok(())
    }

    fn merge(&mut self, other: &Self) {
        let add = |sums: &mut [f64], others: &[f64]| sums.iter_mut().zip(others).for_each(|(sum, other)| *sum += other);
        add(&mut self.both, &other.both);
        add(&mut self.both_squared, &other.both_squared);
        for (sums, others) in [
            (&mut self.product, &other.product),
            (&mut self.change, &other.change),
            (&mut self.change_squared, &other.change_squared),
        ] {
            sums.iter_mut().zip(others).for_each(|(sums, others)| add(sums, others));
        }
    }

    /// Variance, and `V_i` and `T_i` of each input, summed over a group of outputs.
    fn variances(&self, group: Range<usize>, samples: f64) -> Variances {
        let mut result = Variances { whole: 0.0, first_order: vec![0.0; self.product.len()], total: Vec::new() };
        result.total.clone_from(&result.first_order);
        for output in group {
            let mean = self.both[output] / (2.0 * samples);
            result.whole += (self.both_squared[output] / (2.0 * samples) - mean * mean).max(0.0);
            for input in 0..self.product.len() {
                // The mean comes off f(B) here, after the sum.
                let product = self.product[input][output] - mean * self.change[input][output];
                result.first_order[input] += product / samples;
                result.total[input] += self.change_squared[input][output] / (2.0 * samples);
            }
        }
        result
    }
}

struct Variances {
    whole: f64,
    first_order: Vec<f64>,
    total: Vec<f64>,
}

fn shares(replicates: &[Sums], origin: &[f64], group: Range<usize>, samples: f64) -> Shares {
    let count = replicates.len() as f64;
    let outputs = group.len() as f64;
    let mean = |output: usize| {
        origin[output] + replicates.iter().map(|sums| sums.both[output]).sum::<f64>() / (2.0 * samples * count)
    };
    let variances: Vec<Variances> = replicates.iter().map(|sums| sums.variances(group.clone(), samples)).collect();
    let whole: Vec<f64> = variances.iter().map(|variances| variances.whole).collect();
    let sum: f64 = whole.iter().sum();
    // What rounding leaves of a constant is no variance.
    let size = group.clone().map(|output| mean(output).powi(2)).sum::<f64>();
    let varies = sum / count > (16.0 * f64::EPSILON).powi(2) * size && sum > 0.0;
    let of_input = |input: usize| Indices {
        first_order: ratio(variances.iter().map(|v| v.first_order[input]), &whole),
        total: ratio(variances.iter().map(|v| v.total[input]), &whole),
    };
    Shares {
        mean: group.clone().map(mean).sum::<f64>() / outputs,
        standard_deviation: (sum / (count * outputs)).sqrt(),
        indices: varies.then(|| (0..variances[0].total.len()).map(of_input).collect()),
    }
}

/// Σ parts / Σ wholes and its standard error by the jackknife (Quenouille 1956): the ratio without each replicate in turn.
fn ratio(parts: impl Iterator<Item = f64>, wholes: &[f64]) -> Estimate {
    let parts: Vec<f64> = parts.collect();
    let (part, whole): (f64, f64) = (parts.iter().sum(), wholes.iter().sum());
    let value = part / whole;
    let count = parts.len() as f64;
    let left_out: Vec<f64> = parts.iter().zip(wholes).map(|(p, w)| (part - p) / (whole - w)).collect();
    let mean = left_out.iter().sum::<f64>() / count;
    let squares: f64 = left_out.iter().map(|ratio| (ratio - mean).powi(2)).sum();
    Estimate { value, standard_error: ((count - 1.0) / count * squares).sqrt() }
}
