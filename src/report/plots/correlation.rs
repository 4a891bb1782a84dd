//! The correlation matrix of the free parameters.

use crate::job::Case;
use crate::report::chart::{Axis, Cell, Chart, Figure, Layer, Map, PAGE_WIDTH, length};
use crate::report::palette::Scale;

/// Most parameters that are shown; with more, those of the strongest correlations are.
const MOST_PARAMETERS: usize = 24;
/// Up to so many parameters there is room for the numbers.
const MOST_WITH_NUMBERS: usize = 14;

pub(super) fn draw(case: &Case) -> Vec<Figure> {
    let (names, matrix) = (&case.fit.free, &case.fit.correlations);
    if names.len() < 2 || matrix.len() != names.len() {
        return Vec::new();
    }
    let entry = |i: usize, j: usize| matrix[i].get(j).copied().flatten().filter(|r| r.is_finite());
    let shown = strongest(names.len(), entry);
    let numbered: Vec<String> = shown.iter().enumerate().map(|(n, i)| format!("{}  {}", n + 1, names[*i])).collect();
    let numbers: Vec<String> = (1..=shown.len()).map(|n| n.to_string()).collect();
    let rows = shown.iter().map(|i| shown.iter().map(|j| entry(*i, *j)).collect()).collect();
    let size = if shown.len() <= MOST_WITH_NUMBERS { 34.0 } else { 20.0 };
    let mut caption = String::new();
    if shown.len() < names.len() {
        caption += &format!("Of {} free parameters, the {} of the strongest correlations. ", names.len(), shown.len());
    }
    if shown.iter().any(|i| shown.iter().any(|j| entry(*i, *j).is_none())) {
        caption += "Hatched: not available, because a parameter touches a bound or the data leave it open.";
    }
    vec![Figure {
        name: "correlations".to_owned(),
        title: "Correlations of the free parameters".to_owned(),
        caption: caption.trim().to_owned(),
        width: (420 + 48 * u32::try_from(shown.len()).unwrap_or(0)).min(PAGE_WIDTH),
        columns: 1,
        cells: vec![Cell {
            title: String::new(),
            charts: vec![Chart {
                x: Axis::bands("parameter, numbered as in the rows", numbers),
                y: Axis::bands("parameter", numbered).reversed(),
                height: (length(shown.len()) * size).max(60.0),
                layers: vec![Layer::Map(Map {
                    borders: (0..=shown.len()).map(length).collect(),
                    rows,
                    scale: Scale::Diverging { limit: 1.0 },
                    label: "correlation".to_owned(),
                    clipped: String::new(),
                    with_numbers: shown.len() <= MOST_WITH_NUMBERS,
                })],
            }],
        }],
    }]
}

/// All parameters where they are few, else those whose largest correlation with another is largest, in their own order.
fn strongest(count: usize, entry: impl Fn(usize, usize) -> Option<f64>) -> Vec<usize> {
    let strength =
        |i: usize| (0..count).filter(|j| *j != i).filter_map(|j| entry(i, j)).fold(0.0f64, |s, r| s.max(r.abs()));
    let mut indices: Vec<usize> = (0..count).collect();
    indices.sort_by(|a, b| strength(*b).total_cmp(&strength(*a)));
    indices.truncate(MOST_PARAMETERS);
    indices.sort_unstable();
    indices
}
