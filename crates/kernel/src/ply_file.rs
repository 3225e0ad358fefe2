//! The grammar of PLY, checked to the last face before OpenMesh reads it: on a spoilt header it runs forever or crashes,
//! and of a file that is cut off it makes up the rest.

/// What is wrong, and where.
type Checked<T> = std::result::Result<T, String>;

/// How the body is written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Body {
    Text,
    Little,
    Big,
}

/// One number of an element.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Kind {
    bytes: usize,
    float: bool,
    signed: bool,
}

struct Property {
    name: String,
    /// Kind of the count, for lists.
    list: Option<Kind>,
    kind: Kind,
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

/// Refuses what is no PLY file of a mesh.
pub(crate) fn check(bytes: &[u8]) -> Checked<()> {
    let (body, elements, at, line) = header(bytes)?;
    let count = |name: &str| elements.iter().find(|e| e.name == name).map_or(0, |e| e.count);
    let vertices = count("vertex");
    for element in elements.iter().filter(|e| e.name == "vertex") {
        let has = |axis: &&str| element.properties.iter().any(|p| p.name == **axis && p.list.is_none());
        if let Some(axis) = ["x", "y", "z"].iter().find(|a| !has(a)) {
            return Err(format!("its vertices have no property `{axis}`"));
        }
    }
    let corners = |p: &Property| p.list.is_some() && is_corners(&p.name);
    if !elements.iter().any(|e| e.name == "face" && e.count > 0 && e.properties.iter().any(corners)) {
        return Err("has no triangles: export the surface, not its points or lines".to_owned());
    }
    let least = |e: &Element| e.count.saturating_mul(e.properties.len().max(1));
    let all = elements.iter().map(least).fold(0, usize::saturating_add);
    if all > bytes.len() {
        return Err(format!(
            "is cut off: it says it has {all} numbers, but is only {} bytes long",
            bytes.len()
        ));
    }
    let mut numbers: Box<dyn Numbers> = match body {
        Body::Text => Box::new(Text { words: words(&bytes[at..], line).into_iter(), line }),
        _ => Box::new(Binary { bytes, at, big: body == Body::Big }),
    };
    for element in &elements {
        for i in 0..element.count {
            let one = instance(element, vertices, numbers.as_mut());
            one.map_err(|m| format!("{} {i} of {}, {m}", element.name, element.count))?;
        }
    }
    Ok(())
}

fn is_corners(name: &str) -> bool {
    matches!(name, "vertex_indices" | "vertex_index")
}

fn instance(element: &Element, vertices: usize, numbers: &mut dyn Numbers) -> Checked<()> {
    for property in &element.properties {
        let Some(count) = property.list else {
            let value = numbers.next(property.kind)?;
            if element.name == "vertex" && !value.is_finite() {
                return Err(format!("{}: {} is no finite number", numbers.place(), property.name));
            }
            continue;
        };
        let length = numbers.next(count)?;
        let is_face = element.name == "face" && is_corners(&property.name);
        if !(length >= 0.0 && length <= vertices.max(255) as f64) || (is_face && length < 3.0) {
            return Err(format!("{}: {length} is no length of a list of corners", numbers.place()));
        }
        for _ in 0..length as usize {
            let value = numbers.next(property.kind)?;
            if is_face && !(value >= 0.0 && value < vertices as f64) {
                return Err(format!("{}: {value} names none of the {vertices} vertices", numbers.place()));
            }
        }
    }
    Ok(())
}

/// The body's kind, its elements, where it begins, and on which line.
fn header(bytes: &[u8]) -> Checked<(Body, Vec<Element>, usize, usize)> {
    let (mut at, mut number, mut body) = (0, 0, None);
    let mut elements: Vec<Element> = Vec::new();
    while let Some(length) = bytes[at..].iter().position(|b| *b == b'\n') {
        let line = String::from_utf8_lossy(&bytes[at..at + length]).trim().to_owned();
        at += length + 1;
        number += 1;
        let words: Vec<&str> = line.split_whitespace().collect();
        let bad = || format!("line {number}: `{line:.60}` is no line of a PLY header");
        match words.as_slice() {
            ["ply"] if number == 1 => {}
            _ if number == 1 => return Err("line 1: is no PLY file: it does not begin with `ply`".to_owned()),
            ["comment" | "obj_info", ..] => {}
            ["format", kind, "1.0"] => body = Some(body_of(kind).ok_or_else(bad)?),
            ["element", name, count] => {
                let count = count.parse().map_err(|_| bad())?;
                elements.push(Element { name: (*name).to_owned(), count, properties: Vec::new() });
            }
            ["property", rest @ ..] => {
                let property = property(rest).ok_or_else(bad)?;
                elements.last_mut().ok_or_else(bad)?.properties.push(property);
            }
            ["end_header"] => {
                let body = body.ok_or("its header names no format: ascii or binary")?;
                return Ok((body, elements, at, number));
            }
            _ => return Err(bad()),
        }
    }
    match number {
        0 => Err("line 1: is no PLY file: it does not begin with `ply`".to_owned()),
        _ => Err(format!("line {number}: its header is cut off: there is no line `end_header`")),
    }
}

fn body_of(name: &str) -> Option<Body> {
    match name {
        "ascii" => Some(Body::Text),
        "binary_little_endian" => Some(Body::Little),
        "binary_big_endian" => Some(Body::Big),
        _ => None,
    }
}

fn property(words: &[&str]) -> Option<Property> {
    match words {
        ["list", count, kind, name] => {
            let count = kind_of(count).filter(|k| !k.float)?;
            Some(Property { name: (*name).to_owned(), list: Some(count), kind: kind_of(kind)? })
        }
        [kind, name] => Some(Property { name: (*name).to_owned(), list: None, kind: kind_of(kind)? }),
        _ => None,
    }
}

fn kind_of(name: &str) -> Option<Kind> {
    let (bytes, float, signed) = match name {
        "char" | "int8" => (1, false, true),
        "uchar" | "uint8" => (1, false, false),
        "short" | "int16" => (2, false, true),
        "ushort" | "uint16" => (2, false, false),
        "int" | "int32" => (4, false, true),
        "uint" | "uint32" => (4, false, false),
        "float" | "float32" => (4, true, true),
        "double" | "float64" => (8, true, true),
        _ => return None,
    };
    Some(Kind { bytes, float, signed })
}

/// The numbers of a body, one after the other.
trait Numbers {
    fn next(&mut self, kind: Kind) -> Checked<f64>;
    fn place(&self) -> String;
}

struct Text<'a> {
    words: std::vec::IntoIter<(usize, &'a str)>,
    line: usize,
}

/// The words of a text with their lines; what is not text is one bad word.
fn words(bytes: &[u8], header_lines: usize) -> Vec<(usize, &str)> {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return vec![(header_lines + 1, "bytes that are no text")];
    };
    let numbered = text.lines().enumerate().map(|(i, l)| (header_lines + 1 + i, l));
    numbered.flat_map(|(i, l)| l.split_whitespace().map(move |w| (i, w))).collect()
}

impl Numbers for Text<'_> {
    fn next(&mut self, kind: Kind) -> Checked<f64> {
        let Some((line, word)) = self.words.next() else {
            return Err(format!("line {}: is cut off", self.line));
        };
        self.line = line;
        let value = word.parse::<f64>().ok().filter(|v| kind.float || v.fract() == 0.0);
        value.ok_or_else(|| format!("line {line}: `{word:.30}` is no number of its kind"))
    }

    fn place(&self) -> String {
        format!("line {}", self.line)
    }
}

struct Binary<'a> {
    bytes: &'a [u8],
    at: usize,
    big: bool,
}

impl Numbers for Binary<'_> {
    fn next(&mut self, kind: Kind) -> Checked<f64> {
        let Some(own) = self.bytes.get(self.at..self.at + kind.bytes) else {
            return Err(format!("byte {}: is cut off", self.bytes.len()));
        };
        self.at += kind.bytes;
        let mut eight = [0; 8];
        for (k, b) in own.iter().enumerate() {
            eight[if self.big { kind.bytes - 1 - k } else { k }] = *b;
        }
        let whole = u64::from_le_bytes(eight);
        let shift = 64 - 8 * kind.bytes as u32;
        Ok(match (kind.float, kind.bytes) {
            (true, 8) => f64::from_bits(whole),
            (true, _) => f64::from(f32::from_bits(whole as u32)),
            _ if kind.signed => (((whole << shift) as i64) >> shift) as f64,
            _ => whole as f64,
        })
    }

    fn place(&self) -> String {
        format!("byte {}", self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                        property list uchar int vertex_indices\nend_header\n";

    fn text(body: &str) -> Checked<()> {
        check(format!("ply\nformat ascii 1.0\n{HEAD}{body}").as_bytes())
    }

    #[test]
    fn whole_files_pass_in_every_order_of_bytes() {
        assert_eq!(text("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), Ok(()));
        for (name, big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
            let mut file = format!("ply\nformat {name} 1.0\ncomment a\n{HEAD}").into_bytes();
            let points = [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
            points.iter().for_each(|c| file.extend(if big { c.to_be_bytes() } else { c.to_le_bytes() }));
            file.push(3);
            (0..3_i32).for_each(|i| file.extend(if big { i.to_be_bytes() } else { i.to_le_bytes() }));
            assert_eq!(check(&file), Ok(()));
            file.pop();
            assert!(check(&file).unwrap_err().contains("face 0 of 1, byte"));
        }
    }

    #[test]
    fn faults_have_their_place() {
        let says = |body: &str| text(body).unwrap_err();
        assert!(says("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n").contains("line 13: 3 names none of the 3"));
        assert!(says("0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n").contains("line 13: -3 is no length"));
        assert!(says("0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n").contains("line 11: z is no finite number"));
        assert!(says("0 0 0\n1 0 0\n").contains("vertex 2 of 3, line 11: is cut off"));
        let head = |from: &str, to: &str| {
            let file =
                format!("ply\nformat ascii 1.0\n{HEAD}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").replace(from, to);
            check(file.as_bytes()).unwrap_err()
        };
        assert!(head("element vertex", "-lement vertex").contains("line 3"));
        assert!(head("list uchar", "list -char").contains("line 8"));
        assert!(head("property float z\n", "").contains("no property `z`"));
        assert!(head("vertex 3", "vertex 4000000000").contains("cut off"));
    }
}
