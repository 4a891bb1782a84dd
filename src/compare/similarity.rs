//! How alike two pictures are: structure and codes.

use serde::Serialize;

use crate::measure::colour::encode;

/// Structural similarity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Similarity {
    /// Mean over all windows: 1 for equal pictures.
    pub mean: f64,
    /// Windows of which every pixel can be trusted in both pictures.
    pub windows: usize,
}

/// Pixels across a window.
const WINDOW: usize = 11;
/// Standard deviation of a window's weights in pixels.
const DEVIATION: f64 = 1.5;
/// K₁² and K₂² of the article, for codes from 0 to 1.
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// SSIM on luminance, coded for screens from 0 to 1: windows of 11 × 11 pixels with Gaussian weights, every window that lies
/// in the picture (Wang, Bovik, Sheikh and Simoncelli 2004, IEEE Transactions on Image Processing 13:600–612, equation 13,
/// K₁ = 0.01, K₂ = 0.03).
///
/// Windows with a pixel that cannot be trusted are left out. None where no window is left.
pub fn structural_similarity(codes: &[Vec<f64>; 2], width: usize, is_trusted: &[bool]) -> Option<Similarity> {
    let height = codes[0].len().checked_div(width)?;
    if width < WINDOW || height < WINDOW {
        return None;
    }
    let [one, other] = codes;
    let products = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<f64>>();
    let means = [one.clone(), other.clone(), products(one, one), products(other, other), products(one, other)]
        .map(|values| weighted(&values, width));
    let spoiled: Vec<f64> = is_trusted.iter().map(|trusted| if *trusted { 0.0 } else { 1.0 }).collect();
    let spoiled = weighted(&spoiled, width);
    let (mut sum, mut windows) = (0.0, 0usize);
    for window in (0..spoiled.len()).filter(|window| spoiled[*window] == 0.0) {
        let [mean_x, mean_y, square_x, square_y, product] = means.each_ref().map(|values| values[window]);
        let (variance_x, variance_y) = (square_x - mean_x * mean_x, square_y - mean_y * mean_y);
        let covariance = product - mean_x * mean_y;
        sum += (2.0 * mean_x * mean_y + C1) * (2.0 * covariance + C2)
            / ((mean_x * mean_x + mean_y * mean_y + C1) * (variance_x + variance_y + C2));
        windows += 1;
    }
    #[expect(clippy::cast_precision_loss, reason = "a count of pixels is far below 2^53")]
    (windows > 0).then(|| Similarity { mean: sum / windows as f64, windows })
}

/// The weighted mean over each window that lies in the picture, first along rows, then along columns.
fn weighted(values: &[f64], width: usize) -> Vec<f64> {
    let kernel = kernel();
    let across = width - WINDOW + 1;
    let rows: Vec<f64> = values
        .chunks_exact(width)
        .flat_map(|row| row.windows(WINDOW).map(|window| window.iter().zip(kernel).map(|(v, w)| v * w).sum::<f64>()))
        .collect();
    let height = rows.len() / across;
    let mut windows = Vec::with_capacity(across * (height - WINDOW + 1));
    for y in 0..=height - WINDOW {
        for x in 0..across {
            windows.push(kernel.iter().enumerate().map(|(step, weight)| weight * rows[(y + step) * across + x]).sum());
        }
    }
    windows
}

/// Gaussian weights that sum to 1.
fn kernel() -> [f64; WINDOW] {
    #[expect(clippy::cast_precision_loss, reason = "an index below 11")]
    let bell: [f64; WINDOW] =
        std::array::from_fn(|step| (-(step as f64 - 5.0).powi(2) / (2.0 * DEVIATION * DEVIATION)).exp());
    let sum: f64 = bell.iter().sum();
    bell.map(|weight| weight / sum)
}

/// Peak signal to noise ratio in dB: 10 log₁₀ 1/MSE, over the screen codes from 0 to 1 of all three channels.
///
/// None where the pictures are equal, or nothing can be trusted.
pub fn peak_signal_to_noise_db(light: &[Vec<[f32; 3]>; 2], is_trusted: &[bool]) -> Option<f64> {
    let code = |channel: f32| encode(f64::from(channel).clamp(0.0, 1.0));
    let mut sum = 0.0;
    let mut count = 0.0;
    for ((one, other), _) in light[0].iter().zip(&light[1]).zip(is_trusted).filter(|(_, trusted)| **trusted) {
        for (one, other) in one.iter().zip(other) {
            sum += (code(*one) - code(*other)).powi(2);
            count += 1.0;
        }
    }
    (sum > 0.0).then(|| 10.0 * (count / sum).log10())
}
