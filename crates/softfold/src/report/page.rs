//! The pieces of the page: style sheet, tables, figures. All text that comes in is escaped here.

use crate::export::escape_xml;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Pictures keep light paper in the dark: their lines are dark.
pub(super) const STYLE: &str = include_str!("page.css");

/// A table of label and figure.
#[derive(Default)]
pub(super) struct Facts(Vec<[String; 2]>);

impl Facts {
    pub(super) fn row(mut self, label: &str, figure: impl Into<String>) -> Self {
        self.0.push([label.to_owned(), figure.into()]);
        self
    }

    pub(super) fn rows(self, rows: Vec<(&'static str, String)>) -> Self {
        rows.into_iter().fold(self, |facts, (label, figure)| facts.row(label, figure))
    }

    /// The table under a heading of its own.
    pub(super) fn finish(self, heading: &str) -> String {
        let rows: String = self
            .0
            .iter()
            .map(|[l, f]| {
                format!("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escape_xml(l), escape_xml(f))
            })
            .collect();
        format!("<div class=\"facts\"><h3>{}</h3><table>\n{rows}</table></div>\n", escape_xml(heading))
    }
}

/// A table with a head; every cell is text.
pub(super) fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let cells = |tag: &str, row: &mut dyn Iterator<Item = &str>| -> String {
        row.map(|c| format!("<{tag}>{}</{tag}>", escape_xml(c))).collect()
    };
    let mut out = format!(
        "<table class=\"wide\"><thead><tr>{}</tr></thead><tbody>\n",
        cells("th", &mut head.iter().copied())
    );
    for row in rows {
        out.push_str(&format!("<tr>{}</tr>\n", cells("td", &mut row.iter().map(String::as_str))));
    }
    out + "</tbody></table>\n"
}

/// A table whose last column holds times: marked, because they are all that differs between two runs.
pub(super) fn timed_table(head: &[&str], rows: &[Vec<String>]) -> String {
    let mut marked = String::new();
    for line in table(head, rows).split_inclusive('\n') {
        match line.rfind("<td>") {
            Some(at) => {
                marked.push_str(&line[..at]);
                marked.push_str("<td class=\"seconds\">");
                marked.push_str(&line[at + "<td>".len()..]);
            }
            None => marked.push_str(line),
        }
    }
    marked
}

/// A section with its heading; nothing if it has no content.
pub(super) fn section(id: &str, heading: &str, content: &str) -> String {
    if content.trim().is_empty() {
        return String::new();
    }
    format!("<section id=\"{id}\"><h2>{}</h2>\n{content}</section>\n", escape_xml(heading))
}

/// A drawing with its caption; nothing if there is no drawing.
pub(super) fn drawing(svg: &str, title: &str, caption: &str) -> String {
    let Some(start) = svg.find("<svg") else { return String::new() };
    figure(&svg[start..], title, caption)
}

/// A picture with its caption and what stands below it.
pub(super) fn picture(png: &[u8], title: &str, below: &str) -> String {
    let data = STANDARD.encode(png);
    let image = format!("<img alt=\"{}\" src=\"data:image/png;base64,{data}\">", escape_xml(title));
    format!(
        "<figure><div class=\"paper\">{image}</div><figcaption><b>{}</b>{below}</figcaption></figure>\n",
        escape_xml(title)
    )
}

/// A colour bar with its ends.
pub(super) fn legend(legend: &super::picture::Legend) -> String {
    let stops: Vec<_> = legend.stops.iter().map(|[r, g, b]| format!("rgb({r},{g},{b})")).collect();
    format!(
        "<div class=\"legend\"><span>{}</span><div class=\"scale\"><i>{}</i><div class=\"bar\" style=\"background:linear-gradient(to right,{})\"></div><i>{}</i></div></div>",
        escape_xml(&legend.title),
        escape_xml(&legend.min),
        stops.join(","),
        escape_xml(&legend.max)
    )
}

fn figure(content: &str, title: &str, caption: &str) -> String {
    format!(
        "<figure><div class=\"paper\">{content}</div><figcaption><b>{}</b>{}</figcaption></figure>\n",
        escape_xml(title),
        escape_xml(caption)
    )
}
