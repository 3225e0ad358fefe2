//! Numbers and text as files hold them, one way for all formats.

/// A number with at most `decimals` digits after the point and no trailing zeros; never `-0`.
pub fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Text for XML and HTML, in elements and in quoted attributes; control characters, which XML cannot
/// hold, become spaces.
pub fn escape_xml(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// Text on one line: control characters become spaces.
pub fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_without_minus_zero() {
        let cases = [(1.5, "1.5"), (-0.0000001, "0"), (100.0, "100"), (-2.25, "-2.25"), (1e7, "10000000")];
        for (value, text) in cases {
            assert_eq!(number(value, 6), text);
        }
        assert_eq!(number(100.0, 0), "100");
    }

    #[test]
    fn markup_is_escaped() {
        assert_eq!(escape_xml("<a b='c'>\"&\n"), "&lt;a b=&#39;c&#39;&gt;&quot;&amp; ");
    }
}
