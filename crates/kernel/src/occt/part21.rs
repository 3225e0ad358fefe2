//! The same STEP file in fewer bytes: what OpenCascade writes several times is written once, numbers have the digits that
//! mean something, blanks and long numbers of entities go.

use std::collections::HashMap;

/// Decimals of a coordinate, mm: 1e-9 mm is a hundredth of what OpenCascade takes for the same point.
const POINT_DECIMALS: usize = 9;
/// Reals outside of this, but for 0, have an exponent.
const PLAIN: std::ops::Range<f64> = 1e-4..1e12;
/// Lines are broken before this column, as part 21 once asked and all readers take.
const LINE: usize = 80;
/// Entities that are nothing but their own values: of equal ones a single one stands for all. None is a part of the
/// topology, which must keep its own.
const VALUES: [&str; 9] = [
    "CARTESIAN_POINT(",
    "DIRECTION(",
    "VECTOR(",
    "LINE(",
    "AXIS2_PLACEMENT_2D(",
    "AXIS2_PLACEMENT_3D(",
    "B_SPLINE_CURVE_WITH_KNOTS(",
    "DEFINITIONAL_REPRESENTATION(",
    "(GEOMETRIC_REPRESENTATION_CONTEXT(2)",
];

/// A piece of an entity: text that may be broken after it, or the number of another entity.
#[derive(Clone, Debug, PartialEq)]
enum Piece {
    Text(String),
    Entity(u32),
}

/// `#id = pieces;`
#[derive(Clone, Debug, PartialEq)]
struct Entity {
    id: u32,
    pieces: Vec<Piece>,
}

/// A STEP file's text with its data section rewritten; as it was if it has none that is understood.
pub(super) fn tidy(text: &str) -> String {
    let Some((head, rest)) = text.split_once("DATA;") else { return text.to_owned() };
    let Some((data, tail)) = rest.rsplit_once("ENDSEC;") else { return text.to_owned() };
    let Some(mut entities) = entities(data) else { return text.to_owned() };
    mend_densities(&mut entities);
    let same = merged(&entities);
    let mut out = String::with_capacity(text.len());
    out.extend([head, "DATA;\n"]);
    write(&entities, &same, &mut out);
    out.extend(["ENDSEC;", tail]);
    out
}

/// All entities in their order; none if something is not as expected.
fn entities(data: &str) -> Option<Vec<Entity>> {
    let mut rest = data.trim_start();
    let mut all = Vec::new();
    while !rest.is_empty() {
        let (id, after) = number_of(rest.strip_prefix('#')?)?;
        let (pieces, after) = pieces(after.trim_start().strip_prefix('=')?)?;
        all.push(Entity { id, pieces });
        rest = after.trim_start();
    }
    Some(all)
}

fn number_of(text: &str) -> Option<(u32, &str)> {
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    Some((text[..end].parse().ok()?, &text[end..]))
}

/// The pieces up to the semicolon, and what follows it.
fn pieces(text: &str) -> Option<(Vec<Piece>, &str)> {
    let mut pieces = vec![];
    let mut rest = text.trim_start();
    let is_point = rest.starts_with("CARTESIAN_POINT");
    let mut piece = String::new();
    loop {
        rest = rest.trim_start();
        let first = rest.chars().next()?;
        match first {
            ';' => {
                pieces.extend((!piece.is_empty()).then_some(Piece::Text(piece)));
                return Some((pieces, &rest[1..]));
            }
            '#' => {
                let (id, after) = number_of(&rest[1..])?;
                pieces.extend([Piece::Text(std::mem::take(&mut piece)), Piece::Entity(id)]);
                rest = after;
            }
            _ => {
                let end = token_end(rest, first)?;
                piece.push_str(&token(&rest[..end], is_point));
                rest = &rest[end..];
                if first == ',' || first == ')' {
                    pieces.push(Piece::Text(std::mem::take(&mut piece)));
                }
            }
        }
    }
}

/// Where the string, number, word or sign ends that a text begins with.
fn token_end(text: &str, first: char) -> Option<usize> {
    let until = |stops: fn(char) -> bool| text.find(stops).unwrap_or(text.len());
    match first {
        '\'' => string_end(text),
        '0'..='9' | '+' | '-' => Some(until(|c| !(c.is_ascii_digit() || "+-.eE".contains(c)))),
        'A'..='Z' | 'a'..='z' => Some(until(|c| !(c.is_ascii_alphanumeric() || c == '_'))),
        _ => Some(first.len_utf8()),
    }
}

/// Past the closing quote; two quotes stand for one.
fn string_end(text: &str) -> Option<usize> {
    let mut from = 1;
    loop {
        from += text[from..].find('\'')? + 1;
        if !text[from..].starts_with('\'') {
            return Some(from);
        }
        from += 1;
    }
}

/// A token as it is written: reals have their shortest form.
fn token(token: &str, is_point: bool) -> String {
    let is_real = token.starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c)) && token.contains('.');
    match token.parse::<f64>() {
        Ok(value) if is_real && is_point => coordinate(value),
        Ok(value) if is_real => real(value),
        _ => token.replace(['\n', '\r'], ""),
    }
}

fn coordinate(mm: f64) -> String {
    let text = format!("{mm:.POINT_DECIMALS$}");
    let short = text.trim_end_matches('0');
    if short == "-0." { "0.".to_owned() } else { short.to_owned() }
}

/// The shortest form that reads back the same; part 21 wants a point in every real.
fn real(value: f64) -> String {
    if value == 0.0 || PLAIN.contains(&value.abs()) {
        let text = format!("{value:?}");
        return text.strip_suffix('0').filter(|t| t.ends_with('.')).unwrap_or(&text).to_owned();
    }
    let text = format!("{value:E}");
    match text.split_once('E') {
        Some((digits, exponent)) if !digits.contains('.') => format!("{digits}.E{exponent}"),
        _ => text,
    }
}

/// OpenCascade writes densities in cubic grams by square centimetres, and reads them without a look at that; others look.
fn mend_densities(entities: &mut [Entity]) {
    let starts: HashMap<u32, String> = entities.iter().map(|e| (e.id, start(e).to_owned())).collect();
    let of = |id: &u32| starts.get(id).map_or("", String::as_str);
    let refers: HashMap<u32, Vec<u32>> = entities.iter().map(|e| (e.id, referred(e))).collect();
    let unit_of = |element: &u32| refers.get(element).and_then(|r| r.first()).map_or("", of);
    let mut powers: HashMap<u32, &str> = HashMap::new();
    for unit in entities.iter().filter(|e| start(e).starts_with("DERIVED_UNIT(")) {
        let elements = referred(unit);
        if elements.iter().any(|e| unit_of(e).contains("MASS_UNIT")) {
            let power = |e: &u32| if unit_of(e).contains("MASS_UNIT") { "1." } else { "-3." };
            powers.extend(elements.iter().map(|e| (*e, power(e))));
        }
    }
    for entity in entities.iter_mut() {
        if let (Some(power), Some(Piece::Text(last))) = (powers.get(&entity.id), entity.pieces.last_mut()) {
            *last = format!("{power})");
        }
    }
}

/// The text that an entity begins with.
fn start(entity: &Entity) -> &str {
    match entity.pieces.first() {
        Some(Piece::Text(text)) => text,
        _ => "",
    }
}

fn referred(entity: &Entity) -> Vec<u32> {
    let id = |piece: &Piece| if let Piece::Entity(id) = piece { Some(*id) } else { None };
    entity.pieces.iter().filter_map(id).collect()
}

/// Which entity stands for which, where that is another one.
fn merged(entities: &[Entity]) -> HashMap<u32, u32> {
    let mut same: HashMap<u32, u32> = HashMap::new();
    loop {
        // Those that are equal once what they refer to is known to be equal: a point, then its line, then what that bounds.
        let before = same.len();
        let mut first: HashMap<String, u32> = HashMap::new();
        for entity in entities.iter().filter(|e| is_value(e) && !same.contains_key(&e.id)).collect::<Vec<_>>()
        {
            let found = *first.entry(key(entity, &same)).or_insert(entity.id);
            if found != entity.id {
                same.insert(entity.id, found);
            }
        }
        if same.len() == before {
            return same;
        }
    }
}

fn is_value(entity: &Entity) -> bool {
    VALUES.iter().any(|v| start(entity).starts_with(v))
}

fn key(entity: &Entity, same: &HashMap<u32, u32>) -> String {
    let mut key = String::new();
    for piece in &entity.pieces {
        match piece {
            Piece::Text(text) => key.push_str(text),
            Piece::Entity(id) => key.push_str(&format!("#{}", same.get(id).unwrap_or(id))),
        }
    }
    key
}

/// Writes the entities that are left, numbered from 1.
fn write(entities: &[Entity], same: &HashMap<u32, u32>, out: &mut String) {
    let left: Vec<&Entity> = entities.iter().filter(|e| !same.contains_key(&e.id)).collect();
    let number: HashMap<u32, usize> = left.iter().enumerate().map(|(i, e)| (e.id, i + 1)).collect();
    let name = |id: &u32| {
        let kept = same.get(id).unwrap_or(id);
        number.get(kept).map_or_else(|| format!("#{kept}"), |n| format!("#{n}"))
    };
    for entity in left {
        let mut line = out.len();
        out.push_str(&format!("{}=", name(&entity.id)));
        for piece in &entity.pieces {
            let text = match piece {
                Piece::Text(text) => text.clone(),
                Piece::Entity(id) => name(id),
            };
            // Room for the comma or the end that may follow.
            if out.len() - line + text.len() + 2 > LINE {
                out.push('\n');
                line = out.len();
            }
            out.push_str(&text);
        }
        out.push_str(";\n");
    }
}

#[cfg(test)]
mod tests {
    use super::{coordinate, real, tidy};

    #[test]
    fn numbers_keep_what_means_something() {
        let points = [(12.0, "12."), (-0.0, "0."), (1e-12, "0."), (-1.25, "-1.25"), (0.1 + 0.2, "0.3")];
        points.iter().for_each(|(value, text)| assert_eq!(coordinate(*value), *text));
        assert_eq!(coordinate(1_234.123_456_789_4), "1234.123456789");
        let reals = [(1.0, "1."), (0.0, "0."), (1e-7, "1.E-7"), (-1.5e-9, "-1.5E-9"), (0.25, "0.25")];
        reals.iter().for_each(|(value, text)| assert_eq!(real(*value), *text));
        for value in [0.1 + 0.2, 1e300, -7.0 / 3.0, 1e12] {
            assert_eq!(real(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
            assert!(real(value).contains('.'));
        }
    }

    #[test]
    fn equal_values_are_written_once_and_the_rest_keeps_its_own() {
        let text = "HEADER;\nENDSEC;\nDATA;\n#10 = VERTEX_POINT('a;''#1',#12);\n#11 = VERTEX_POINT('',#14);\n\
                    #12 = CARTESIAN_POINT('',(1.0000000000001,\n  2.,-0.));\n#14 = CARTESIAN_POINT('',(1.,2.,0.));\n\
                    #20 = VECTOR('',#21,1.000000000000);\n#21 = DIRECTION('',(1.,0.));\n#22 = VECTOR('',#23,1.);\n\
                    #23 = DIRECTION('',(1.,0.));\n#30 = PAIR(#22,#20,.T.);\n#31 = ( A(2)\nB('x y') );\nENDSEC;\nEND;\n";
        let wanted = "HEADER;\nENDSEC;\nDATA;\n#1=VERTEX_POINT('a;''#1',#3);\n#2=VERTEX_POINT('',#3);\n\
                      #3=CARTESIAN_POINT('',(1.,2.,0.));\n#4=VECTOR('',#5,1.);\n#5=DIRECTION('',(1.,0.));\n\
                      #6=PAIR(#4,#4,.T.);\n#7=(A(2)B('x y'));\nENDSEC;\nEND;\n";
        assert_eq!(tidy(text), wanted);
        assert_eq!(tidy(wanted), wanted, "tidy text stays as it is");
    }

    #[test]
    fn densities_are_grams_by_cubic_centimetres() {
        let text = |mass, length| {
            format!(
                "DATA;\n#1=DERIVED_UNIT((#2,#4));\n#2=DERIVED_UNIT_ELEMENT(#3,{mass});\n#3=(MASS_UNIT()NAMED_UNIT(*)SI_UNIT($,.GRAM.));\n\
                 #4=DERIVED_UNIT_ELEMENT(#5,{length});\n#5=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.));\n\
                 #6=DERIVED_UNIT((#7));\n#7=DERIVED_UNIT_ELEMENT(#5,2.);\nENDSEC;\n"
            )
        };
        assert_eq!(tidy(&text("3.", "2.")), text("1.", "-3."));
    }

    #[test]
    fn lines_are_short_and_what_is_not_understood_stays() {
        let list: Vec<String> = (1..200).map(|i| format!("#{i}")).collect();
        let text = format!("DATA;\n#1 = LIST(({}));\nENDSEC;\n", list.join(","));
        let tidied = tidy(&text);
        assert!(tidied.lines().all(|l| l.len() <= 80), "{tidied}");
        assert_eq!(tidied.replace('\n', ""), text.replace(['\n', ' '], ""));
        for odd in ["", "DATA;\n#1 = A('", "DATA;\nA(1);\nENDSEC;", "DATA;\n#1 = A(#);ENDSEC;"] {
            assert_eq!(tidy(odd), odd);
        }
    }
}
