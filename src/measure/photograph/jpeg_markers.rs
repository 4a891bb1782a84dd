//! What a JPEG's markers say before it is decoded.
//!
//! The decoder paints whatever a broken file lacks grey, and turns inks into light by a rule of thumb. Both are seen here
//! first: the segments are walked from the start of the image to its end (ITU-T T.81, annex B).

/// What the markers say.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct JpegMarkers {
    /// Number of channels; 4 are inks.
    pub(super) channels: Option<u8>,
    /// Bits a channel.
    pub(super) bits: Option<u8>,
    /// Dots along x and y, and the unit's size in µm, as JFIF has them.
    pub(super) density: Option<([u16; 2], f64)>,
    /// Whether the end of the image was reached.
    pub(super) is_whole: bool,
}

impl JpegMarkers {
    /// Walks the segments; stops where they end or make no sense.
    pub(super) fn read(bytes: &[u8]) -> Self {
        let mut found = Self::default();
        // Behind the start of the image.
        let mut at = 2;
        while let Some(marker) = next_marker(bytes, &mut at) {
            match marker {
                0xD9 => {
                    found.is_whole = true;
                    return found;
                }
                // Restarts and the like have no length.
                0x01 | 0xD0..=0xD8 => {}
                _ => {
                    let Some(length) = two(bytes, at).map(usize::from) else { return found };
                    let end = at.saturating_add(length.max(2)).min(bytes.len());
                    found.note(marker, &bytes[(at + 2).min(end)..end]);
                    at = end;
                }
            }
        }
        found
    }

    fn note(&mut self, marker: u8, body: &[u8]) {
        let is_frame = matches!(marker, 0xC0..=0xCF) && !matches!(marker, 0xC4 | 0xC8 | 0xCC);
        if is_frame && body.len() >= 6 {
            (self.bits, self.channels) = (Some(body[0]), Some(body[5]));
        }
        if marker == 0xE0 && body.starts_with(b"JFIF\0") && body.len() >= 12 {
            let unit_um = match body[7] {
                1 => 25_400.0,
                2 => 10_000.0,
                _ => return,
            };
            self.density = two(body, 8).zip(two(body, 10)).map(|(x, y)| ([x, y], unit_um));
        }
    }
}

/// Finds the next marker, over the codes of a scan if need be, and steps behind it.
fn next_marker(bytes: &[u8], at: &mut usize) -> Option<u8> {
    loop {
        let start = *at + bytes.get(*at..)?.iter().position(|byte| *byte == 0xFF)?;
        let marker = *bytes.get(start + 1)?;
        // A stuffed zero belongs to the codes; a second 0xFF fills.
        *at = if marker == 0xFF { start + 1 } else { start + 2 };
        if !matches!(marker, 0x00 | 0xFF) {
            return Some(marker);
        }
    }
}

fn two(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_be_bytes([*bytes.get(at)?, *bytes.get(at + 1)?]))
}
