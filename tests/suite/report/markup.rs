//! Just enough of a parser to hold pages and plots to account.

/// Elements that HTML never closes.
const VOID: [&str; 4] = ["meta", "br", "!DOCTYPE", "hr"];

/// A piece of markup: a tag without its angle brackets, or text.
enum Piece<'a> {
    Tag(&'a str),
    Text(&'a str),
}

/// Tags and texts in order; a style sheet counts as text.
fn pieces(markup: &str) -> Vec<Piece<'_>> {
    let mut pieces = Vec::new();
    let mut rest = markup;
    while let Some((text, after)) = rest.split_once('<') {
        pieces.push(Piece::Text(text));
        // A > inside a quoted attribute does not end the tag.
        let mut is_quoted = false;
        let end = after
            .char_indices()
            .find(|(_, c)| {
                is_quoted ^= *c == '"';
                *c == '>' && !is_quoted
            })
            .unwrap_or_else(|| panic!("a tag does not end: <{}", after.chars().take(40).collect::<String>()))
            .0;
        pieces.push(Piece::Tag(&after[..end]));
        rest = &after[end + 1..];
    }
    pieces.push(Piece::Text(rest));
    pieces
}

/// Every element is closed in order, and no bare `<` or `&` stands in a text.
pub(crate) fn assert_well_formed(markup: &str) {
    let mut open: Vec<&str> = Vec::new();
    for piece in pieces(markup) {
        match piece {
            Piece::Tag(tag) => {
                let name = tag.trim_start_matches('/').split([' ', '\n', '/']).next().unwrap();
                assert!(name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '!'), "no tag: <{tag}>");
                if tag.starts_with('/') {
                    assert_eq!(open.pop(), Some(name), "closed out of order");
                } else if !tag.ends_with('/') && !VOID.contains(&name) {
                    open.push(name);
                }
                assert!(tag.matches('"').count() % 2 == 0, "an attribute is not closed: <{tag}>");
            }
            Piece::Text(text) => {
                if open.last() == Some(&"style") {
                    continue;
                }
                for (index, _) in text.match_indices('&') {
                    let entity: String = text[index..].chars().take(8).collect();
                    assert!(entity.contains(';'), "a bare ampersand: {entity}");
                }
            }
        }
    }
    assert!(open.is_empty(), "never closed: {open:?}");
}

/// Every text that a reader sees, entities resolved, blank ones left out.
pub(super) fn texts(markup: &str) -> Vec<String> {
    let mut texts = Vec::new();
    let mut is_style = false;
    for piece in pieces(markup) {
        match piece {
            Piece::Tag(tag) => is_style = tag.starts_with("style"),
            Piece::Text(text) if !is_style && !text.trim().is_empty() => texts.push(resolved(text.trim())),
            Piece::Text(_) => {}
        }
    }
    texts
}

/// Values of an attribute, in order.
pub(crate) fn attributes(markup: &str, name: &str) -> Vec<String> {
    let start = format!(" {name}=\"");
    let tags = pieces(markup).into_iter().filter_map(|p| if let Piece::Tag(tag) = p { Some(tag) } else { None });
    tags.filter_map(|tag| Some(resolved(tag.split_once(&start)?.1.split_once('"')?.0))).collect()
}

fn resolved(text: &str) -> String {
    [
        ("&#60;", "<"),
        ("&lt;", "<"),
        ("&#62;", ">"),
        ("&gt;", ">"),
        ("&#34;", "\""),
        ("&quot;", "\""),
        ("&#39;", "'"),
        ("&apos;", "'"),
        ("&#38;", "&"),
        ("&amp;", "&"),
    ]
    .iter()
    .fold(text.to_owned(), |text, (entity, character)| text.replace(entity, character))
}

/// Texts that end at their point, as the numbers beside a y axis do, in the order of the file.
pub(super) fn end_aligned(svg: &str) -> Vec<String> {
    let all = pieces(svg);
    let labels = all.windows(2).filter_map(|pair| match pair {
        [Piece::Tag(tag), Piece::Text(text)] if tag.contains("text-anchor=\"end\"") => Some(resolved(text.trim())),
        _ => None,
    });
    labels.collect()
}

/// A label's box in the units of its SVG.
struct Label {
    text: String,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

/// No two labels of an SVG overlap, and all lie inside its view box.
///
/// A browser's own sans-serif is about half as wide as it is high; a box 0.5 em a character and 0.7 em high is what
/// certainly is covered.
pub(super) fn assert_labels_apart(name: &str, svg: &str) {
    let view: Vec<f64> = attributes(svg, "viewBox")[0].split(' ').map(|part| part.parse().unwrap()).collect();
    let mut labels: Vec<Label> = Vec::new();
    let all = pieces(svg);
    for pair in all.windows(2) {
        let [Piece::Tag(tag), Piece::Text(text)] = pair else { continue };
        if !tag.starts_with("text ") {
            continue;
        }
        let attribute = |name: &str| {
            let start = format!(" {name}=\"");
            tag.split_once(&start).map(|(_, after)| after.split_once('"').unwrap().0)
        };
        let number = |name: &str| attribute(name).unwrap().parse::<f64>().unwrap();
        let text = resolved(text.trim());
        let (x, y, size) = (number("x"), number("y"), number("font-size"));
        let length = 0.5 * size * text.chars().count() as f64;
        let start = match attribute("text-anchor").unwrap() {
            "start" => 0.0,
            "middle" => -0.5 * length,
            _ => -length,
        };
        let half = 0.35 * size;
        labels.push(if attribute("transform").is_some_and(|t| t.starts_with("rotate(270")) {
            Label { text, left: x - half, right: x + half, top: y - start - length, bottom: y - start }
        } else {
            Label { text, left: x + start, right: x + start + length, top: y - half, bottom: y + half }
        });
    }
    assert!(!labels.is_empty(), "{name} has no labels");
    for (index, one) in labels.iter().enumerate() {
        let is_inside = one.left >= view[0] && one.right <= view[2] && one.top >= view[1] && one.bottom <= view[3];
        assert!(is_inside, "{name}: the label {:?} leaves the figure", one.text);
        for other in &labels[..index] {
            let overlaps =
                one.left < other.right && other.left < one.right && one.top < other.bottom && other.top < one.bottom;
            assert!(!overlaps, "{name}: the labels {:?} and {:?} overlap", one.text, other.text);
        }
    }
}
