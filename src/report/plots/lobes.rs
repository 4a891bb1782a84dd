//! Lobes of a model: in the plane of incidence, and over the hemisphere of viewers.

use crate::job::{Case, Lobes};
use crate::report::chart::{Axis, Cell, Chart, Figure, Look, PAGE_WIDTH, Series, length};
use crate::report::disc::{Disc, Dome, LobeChart, Radius};
use crate::report::palette::{BLACK, BLUE, Colour, GREEN, GREY, SKY, VERMILION};

/// Looks of curves beside each other: no two share both colour and dashes.
const LOOKS: [(Colour, bool); 6] =
    [(BLUE, false), (GREEN, true), (VERMILION, false), (BLACK, true), (SKY, false), (GREY, true)];
/// What the lobes show.
const QUANTITY: &str = "BSDF (1/sr)";
/// A lobe that spans more than this factor has its colours in logarithms.
const WIDE: f64 = 8.0;
/// How far a logarithmic colour scale reaches down from the brightest.
const DECADES: f64 = 1e3;

pub(super) fn draw(case: &Case) -> Vec<Figure> {
    case.lobes.as_ref().map_or_else(Vec::new, |lobes| figures(&[("fitted model".to_owned(), lobes.clone())]))
}

/// The figures of a model at one setting of its parameters or several, which are told apart by their words.
pub(crate) fn figures(settings: &[(String, Lobes)]) -> Vec<Figure> {
    let Some((_, first)) = settings.first().filter(|(_, lobes)| !lobes.lights.is_empty()) else { return Vec::new() };
    vec![in_plane(settings, first), hemispheres(settings, first)]
}

fn light_title(theta_i_deg: f64) -> String {
    format!("light at {}°", crate::number::plain(theta_i_deg))
}

fn in_plane(settings: &[(String, Lobes)], first: &Lobes) -> Figure {
    let middle = first.wavelengths_nm.len() / 2;
    let is_alone = settings.len() == 1;
    // One setting is shown at each wavelength, several at the middle one.
    let curves = |light: usize| -> Vec<Series> {
        let curve = |name: String, lobes: &Lobes, channel: usize, place: usize| {
            let (colour, dashed) = LOOKS[place % LOOKS.len()];
            // The first widest, so that one that lies under another still shows.
            let width = (3.8 - 1.1 * length(place)).max(1.4);
            let values = lobes.lights[light].in_plane[channel].iter().copied();
            Series::new(name, lobes.angles_deg.iter().copied().zip(values), Look::Line { colour, width, dashed })
        };
        if is_alone {
            let channels = first.wavelengths_nm.iter().enumerate();
            channels.map(|(channel, nm)| curve(format!("{nm} nm"), first, channel, channel)).collect()
        } else {
            settings
                .iter()
                .enumerate()
                .map(|(place, (words, lobes))| curve(words.clone(), lobes, middle, place))
                .collect()
        }
    };
    let all: Vec<Vec<Series>> = (0..first.lights.len()).map(curves).collect();
    let radius = Radius::of(all.iter().flatten().flat_map(|series| &series.points).map(|point| point.y));
    let has_below = all.iter().flatten().flat_map(|series| &series.points).any(|point| point.x > 90.0);
    let cells = first.lights.iter().zip(all).map(|(light, curves)| Cell {
        title: light_title(light.theta_i_deg),
        charts: vec![Chart::disc(
            if has_below { 300.0 } else { 170.0 },
            Disc::Lobes(LobeChart {
                curves,
                light_deg: light.theta_i_deg,
                has_below,
                radius,
                label: QUANTITY.to_owned(),
            }),
        )],
    });
    let sentences = [
        "What a viewer sees in the plane of incidence, for light from the left (dashed line); the distance from the middle is \
         the BSDF in 1/sr, numbered below the surface on the left.",
        if radius.is_root { "Distances go with the cube root of values, or a gloss would hide all else." } else { "" },
        if has_below { "Below the surface is what shines through." } else { "" },
        if is_alone { "" } else { "Curves are for the middle wavelength." },
        "All panels share one scale. The light comes from azimuth 0, the direction of the tangent where it is not turned.",
    ];
    Figure {
        name: "lobes".to_owned(),
        title: "Lobes in the plane of incidence (dashed: the light)".to_owned(),
        caption: sentences.into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join(" "),
        width: PAGE_WIDTH,
        columns: first.lights.len().clamp(1, 3),
        cells: cells.collect(),
    }
}

fn hemispheres(settings: &[(String, Lobes)], first: &Lobes) -> Figure {
    let values = || {
        let lights = settings.iter().flat_map(|(_, lobes)| &lobes.lights);
        lights.flat_map(|light| light.hemisphere.iter().flatten().copied()).filter(|value| *value > 0.0)
    };
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
    let is_wide = high > WIDE * low;
    let colours = match (high > 0.0, is_wide) {
        (false, _) => Axis::linear(QUANTITY, (0.0, 1.0)),
        (true, false) => Axis::linear(QUANTITY, (0.0, high)),
        (true, true) => Axis::logarithmic(QUANTITY, (low.max(high / DECADES), high)),
    };
    let colours = &colours;
    let cells = settings.iter().flat_map(|(words, lobes)| {
        lobes.lights.iter().map(move |light| {
            let rings = light.hemisphere.clone();
            let disc = Disc::Dome(Dome { rings, colours: colours.clone(), light_deg: (light.theta_i_deg, 0.0) });
            let title = match settings.len() {
                1 => light_title(light.theta_i_deg),
                _ => format!("{words}, {}", light_title(light.theta_i_deg)),
            };
            Cell { title, charts: vec![Chart::disc(270.0, disc)] }
        })
    });
    let sentences = [
        format!(
            "All viewers above the surface, seen from above at {} nm: the normal is in the middle, inclinations of 30° and 60° \
             are circles, azimuths are written at the rim, equal areas are equal solid angles.",
            first.wavelengths_nm[first.wavelengths_nm.len() / 2]
        ),
        "The disc is the light, the diamond its mirror direction. A cell is the mean over 4.5° of inclination and 6° of \
         azimuth, so that a narrower lobe is blurred."
            .to_owned(),
        if is_wide { "Colours go with the logarithm; what is darker than the scale has its darkest.".to_owned() } else { String::new() },
    ];
    Figure {
        name: "hemisphere".to_owned(),
        title: "Lobes over the hemisphere of viewers (disc: the light, diamond: its mirror direction)".to_owned(),
        caption: sentences.into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join(" "),
        width: PAGE_WIDTH,
        columns: first.lights.len().clamp(1, 3),
        cells: cells.collect(),
    }
}
