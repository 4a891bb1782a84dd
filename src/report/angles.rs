//! How geometries are named in titles and tables, and which of many spectra are shown.

use crate::job::SpectrumFit;
use crate::measure::Geometry;

/// Most spectra that are shown one by one.
const MOST_PANELS: usize = 15;
/// About how many are chosen where there are more.
const WANTED_PANELS: usize = 12;
/// Most rows of an angle × wavelength map.
const MOST_ROWS: usize = 60;

/// Whether the viewer stands in the mirror direction, so that one angle says it all.
pub(crate) fn is_mirror(geometry: &Geometry) -> bool {
    let turn = (geometry.phi_o_deg - geometry.phi_i_deg).rem_euclid(360.0);
    (geometry.theta_i_deg - geometry.theta_o_deg).abs() < 1e-6 && (turn - 180.0).abs() < 1e-6
}

/// A name for each spectrum: its angles, or its own name where nobody wrote them down.
pub(crate) fn spectrum_names(spectra: &[SpectrumFit]) -> Vec<String> {
    if spectra.iter().any(|spectrum| spectrum.without_geometry) {
        return spectra.iter().map(|spectrum| spectrum.id.clone()).collect();
    }
    names(spectra.iter().map(|spectrum| &spectrum.geometry))
}

/// What the names of [`spectrum_names`] mean.
pub(crate) fn spectrum_meaning(spectra: &[SpectrumFit]) -> &'static str {
    if spectra.iter().any(|spectrum| spectrum.without_geometry) {
        return "The table does not say where light and viewer stood.";
    }
    meaning(spectra.iter().map(|spectrum| &spectrum.geometry))
}

/// A name for each geometry, short where all are mirror geometries.
pub(crate) fn names<'a>(geometries: impl Iterator<Item = &'a Geometry> + Clone) -> Vec<String> {
    let all_mirror = geometries.clone().all(is_mirror);
    geometries
        .map(|g| {
            if all_mirror {
                format!("{}°", angle(g.theta_i_deg))
            } else {
                format!("{}° → {}°, {}°", angle(g.theta_i_deg), angle(g.theta_o_deg), angle(g.phi_o_deg - g.phi_i_deg))
            }
        })
        .collect()
}

/// What the names of [`names`] mean.
pub(crate) fn meaning<'a>(mut geometries: impl Iterator<Item = &'a Geometry>) -> &'static str {
    if geometries.all(is_mirror) {
        "Angles are inclinations θ of light and viewer from the normal, in mirror position."
    } else {
        "Angles are θᵢ → θₒ, φ: inclinations of light and viewer from the normal, and the viewer's azimuth from the light's."
    }
}

fn angle(degrees: f64) -> String {
    let text = crate::number::to_place(degrees, -1);
    text.strip_suffix(".0").unwrap_or(&text).to_owned()
}

/// Spectra chosen for display, as indices in the order of their angles, and how they were chosen.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Selection {
    pub(crate) indices: Vec<usize>,
    /// A sentence where some are left out.
    pub(crate) text: Option<String>,
}

/// All spectra where they are few; otherwise, at each incidence of the light, those between the best and the worst fit.
pub(crate) fn representative(spectra: &[SpectrumFit]) -> Selection {
    let sorted = by_angle(spectra);
    if sorted.len() <= MOST_PANELS {
        return Selection { indices: sorted, text: None };
    }
    let mut incidences: Vec<Vec<usize>> = Vec::new();
    for index in sorted {
        let theta = |i: usize| spectra[i].geometry.theta_i_deg;
        match incidences.last_mut().filter(|g| (theta(g[0]) - theta(index)).abs() < 1e-6) {
            Some(group) => group.push(index),
            None => incidences.push(vec![index]),
        }
    }
    let total = incidences.len();
    let incidences: Vec<Vec<usize>> =
        evenly(total, WANTED_PANELS).into_iter().map(|i| std::mem::take(&mut incidences[i])).collect();
    let each = (WANTED_PANELS / incidences.len()).max(1);
    let mut indices = Vec::new();
    for group in &incidences {
        // A spectrum whose readings are all 0 has no misfit beside them.
        let mut ranked: Vec<(f64, usize)> = group.iter().filter_map(|i| Some((misfit(&spectra[*i])?, *i))).collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        if ranked.is_empty() {
            continue;
        }
        let ranks = if each == 1 { vec![ranked.len() / 2] } else { evenly(ranked.len(), each) };
        // Two ranks are the median and the worst: the best of many flatters.
        let ranks = if each == 2 && ranked.len() > 2 { vec![ranked.len() / 2, ranked.len() - 1] } else { ranks };
        indices.extend(ranks.into_iter().map(|rank| ranked[rank].1));
    }
    let chosen = match each {
        1 => "the one with the median misfit",
        2 => "the one with the median misfit and the one with the largest",
        _ => "some from the smallest misfit to the largest",
    };
    let place = if spectra.iter().any(|spectrum| spectrum.without_geometry) {
        String::new()
    } else if incidences.len() < total {
        format!("at {} of the {total} incidences of the light, ", incidences.len())
    } else if total == 1 {
        "at the one incidence of the light, ".to_owned()
    } else {
        format!("at each of the {total} incidences of the light, ")
    };
    let text = format!(
        "Of {} spectra {} are shown: {place}{chosen} (misfit: root mean square residual over the mean reading).",
        spectra.len(),
        indices.len(),
    );
    Selection { indices, text: Some(text) }
}

/// Rows of a map: all spectra, or evenly spread ones where there are too many to tell apart.
pub(crate) fn rows(spectra: &[SpectrumFit]) -> Selection {
    let sorted = by_angle(spectra);
    let chosen = evenly(sorted.len(), MOST_ROWS);
    let text = (chosen.len() < sorted.len()).then(|| {
        format!("Of {} spectra, {} evenly spread in the order of their angles are shown.", sorted.len(), chosen.len())
    });
    Selection { indices: chosen.into_iter().map(|i| sorted[i]).collect(), text }
}

fn by_angle(spectra: &[SpectrumFit]) -> Vec<usize> {
    let mut indices: Vec<usize> = (0..spectra.len()).collect();
    let key = |i: &usize| {
        let g = &spectra[*i].geometry;
        [g.theta_i_deg, g.phi_i_deg, g.phi_o_deg, g.theta_o_deg]
    };
    indices.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a.iter().zip(&b).map(|(x, y)| x.total_cmp(y)).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
    });
    indices
}

/// At most `wanted` of `0..count`, first and last among them.
pub(crate) fn evenly(count: usize, wanted: usize) -> Vec<usize> {
    if count <= wanted {
        return (0..count).collect();
    }
    if wanted < 2 {
        return (0..count).take(wanted).collect();
    }
    (0..wanted).map(|i| i * (count - 1) / (wanted - 1)).collect()
}

/// Root mean square residual over the mean size of a reading; nothing where all readings are 0.
fn misfit(spectrum: &SpectrumFit) -> Option<f64> {
    let (mut count, mut squares, mut sizes) = (0.0, 0.0, 0.0);
    for reading in super::readings::of(spectrum) {
        count += 1.0;
        squares += reading.residual().powi(2);
        sizes += reading.measured.abs();
    }
    (sizes > 0.0).then(|| f64::sqrt(squares / count) / (sizes / count))
}
