//! Mesh files are checked before a library reads them: OpenMesh tells only that a file is bad, if it tells, and on some that
//! are spoilt it runs forever or crashes.

use crate::error::{KernelError, Result};
use crate::ply_file;
use std::path::Path;

/// Endings of files that can be read.
const ENDINGS: [&str; 4] = ["ply", "obj", "stl", "off"];
/// Header and count of binary STL, and one triangle, bytes.
const STL_HEAD: usize = 84;
const STL_TRIANGLE: usize = 50;

/// Refuses a file that is no mesh, or not a whole one.
///
/// # Errors
/// An ending that is none of a mesh, an empty file, another kind of file than the ending says, one that is cut off or
/// spoilt: with the line or the byte, and a mend.
pub(crate) fn check(path: &Path, bytes: &[u8]) -> Result<()> {
    let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).unwrap_or_default();
    let refused = |message: String| KernelError::file(path, message);
    if !ENDINGS.contains(&ending.as_str()) {
        return Err(refused("has no ending of a mesh; give ply, obj, stl or off".to_owned()));
    }
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(refused("is empty; export it again".to_owned()));
    }
    let checked = match ending.as_str() {
        "ply" => ply_file::check(bytes),
        "off" => off(bytes),
        "stl" => stl(bytes),
        _ => obj(bytes),
    };
    checked.map_err(|m| refused(format!("{m}; export it again")))
}

type Checked = std::result::Result<(), String>;

/// OpenMesh reads ASCII OFF without comments; on a negative count it runs forever.
fn off(bytes: &[u8]) -> Checked {
    let Ok(text) = std::str::from_utf8(bytes) else { return Err("is no OFF file of text".to_owned()) };
    let mut lines = text.lines().enumerate().map(|(i, l)| (i + 1, l.trim())).filter(|(_, l)| !l.is_empty());
    let Some((_, first)) = lines.next().filter(|(_, l)| is_off(l)) else {
        return Err("line 1: is no OFF file: it does not begin with `OFF`".to_owned());
    };
    if let Some((line, _)) = lines.clone().find(|(_, l)| l.starts_with('#')) {
        return Err(format!("line {line}: has a comment, which OpenMesh cannot read; take it out"));
    }
    // The counts stand on the next line, or on the first one.
    let beside = first.split_once("OFF").map(|(_, rest)| rest.trim()).filter(|rest| !rest.is_empty());
    let Some((line, counts)) = beside.map(|c| (1, c)).or_else(|| lines.next()) else {
        return Err("is cut off after its first line".to_owned());
    };
    let mut words = counts.split_whitespace().map(str::parse::<usize>);
    let (Some(Ok(vertices)), Some(Ok(faces))) = (words.next(), words.next()) else {
        return Err(format!("line {line}: the counts of vertices and faces are no numbers: {counts:.60}"));
    };
    if faces == 0 {
        return Err("has no triangles: export the surface, not its points or lines".to_owned());
    }
    let cut = |what: &str, i: usize, of: usize| {
        format!("is cut off: it says it has {of} {what}, but ends after {i}")
    };
    for i in 0..vertices {
        let (line, text) = lines.next().ok_or_else(|| cut("vertices", i, vertices))?;
        point(line, text, text)?;
    }
    for i in 0..faces {
        let (line, text) = lines.next().ok_or_else(|| cut("faces", i, faces))?;
        off_face(line, text, vertices)?;
    }
    Ok(())
}

fn is_off(line: &str) -> bool {
    let word = line.split_whitespace().next().unwrap_or_default();
    matches!(word, "OFF" | "COFF" | "NOFF" | "CNOFF") && !line.contains("BINARY")
}

fn off_face(line: usize, text: &str, vertices: usize) -> Checked {
    let mut words = text.split_whitespace().map(str::parse::<usize>);
    let corners = match words.next() {
        Some(Ok(n)) if n >= 3 => n,
        _ => return Err(format!("line {line}: a face begins with the number of its corners: {text:.60}")),
    };
    let named = words.take(corners).filter(|v| v.as_ref().is_ok_and(|v| *v < vertices)).count();
    match named == corners {
        true => Ok(()),
        false => Err(format!("line {line}: a face names {corners} of the {vertices} vertices: {text:.60}")),
    }
}

/// Refuses less than three finite numbers.
fn point(line: usize, numbers: &str, text: &str) -> Checked {
    let finite = |w: &&str| w.parse::<f64>().is_ok_and(f64::is_finite);
    match numbers.split_whitespace().take(3).filter(finite).count() {
        3 => Ok(()),
        _ => Err(format!("line {line}: a vertex needs three finite numbers: {text:.60}")),
    }
}

fn stl(bytes: &[u8]) -> Checked {
    let count = bytes.get(80..STL_HEAD).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let needed = |faces: usize| faces.saturating_mul(STL_TRIANGLE).saturating_add(STL_HEAD);
    match count {
        Some(faces) if needed(faces) == bytes.len() => Ok(()),
        _ if is_text_stl(bytes) => text_stl(bytes),
        Some(faces) if needed(faces) > bytes.len() => Err(format!(
            "is no STL file, or cut off: for the {faces} triangles that it says it has it would be {} bytes long, not {}",
            needed(faces),
            bytes.len()
        )),
        Some(_) => Ok(()),
        None => Err(format!("is no STL file: {} bytes are fewer than its header has", bytes.len())),
    }
}

/// Binary files may begin with `solid` too: only in text is there a facet on the second line.
fn is_text_stl(bytes: &[u8]) -> bool {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(1024)]).to_ascii_lowercase();
    head.trim_start().starts_with("solid") && (head.contains("facet") || head.contains("endsolid"))
}

fn text_stl(bytes: &[u8]) -> Checked {
    let text = String::from_utf8_lossy(bytes);
    let mut last = 0;
    for (i, line) in text.lines().enumerate() {
        if let Some(numbers) = line.trim().strip_prefix("vertex") {
            point(i + 1, numbers, line.trim())?;
        }
        last = i + 1;
    }
    match text.to_ascii_lowercase().contains("endsolid") {
        true => Ok(()),
        false => Err(format!("is cut off at line {last}: there is no line `endsolid`")),
    }
}

fn obj(bytes: &[u8]) -> Checked {
    if bytes.contains(&0) {
        return Err("is no OBJ file: it is not text".to_owned());
    }
    let mut vertices = 0;
    for (i, line) in String::from_utf8_lossy(bytes).lines().enumerate() {
        let line = line.trim();
        match line.split_once(char::is_whitespace) {
            Some(("v", numbers)) => {
                vertices += 1;
                point(i + 1, numbers, line)?;
            }
            Some(("f", corners)) => obj_face(i + 1, corners, vertices)?,
            _ => {}
        }
    }
    Ok(())
}

fn obj_face(line: usize, text: &str, vertices: usize) -> Checked {
    let corners: Vec<&str> = text.split_whitespace().collect();
    if let Some(bad) = corners.iter().find(|c| !is_corner(c, vertices)) {
        return Err(format!("line {line}: `{bad:.30}` names none of the {vertices} vertices so far"));
    }
    match corners.len() {
        0..3 => Err(format!("line {line}: a face needs three corners: {text:.60}")),
        _ => Ok(()),
    }
}

/// `7`, `7/1`, `7//3` or `-1`, counted from the end.
fn is_corner(word: &str, vertices: usize) -> bool {
    let number = word.split('/').next().unwrap_or_default().parse::<i64>();
    number.is_ok_and(|n| n != 0 && n.unsigned_abs() as usize <= vertices)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn says(name: &str, bytes: &[u8]) -> String {
        check(Path::new(name), bytes).map_or_else(|e| e.to_string(), |()| "fine".to_owned())
    }

    #[test]
    fn faults_have_their_place() {
        let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n";
        assert!(says("a.obj", obj.as_bytes()).contains("line 4: `4` names none of the 3"));
        assert!(says("a.obj", b"v 0 0\n").contains("line 1"));
        assert!(says("a.obj", b"v 0 nan 0\n").contains("line 1"));
        assert!(says("a.ply", b"ply\nelement vertex many\n").contains("line 2"));
        assert!(says("a.ply", b"ply\nformat ascii 1.0\n").contains("end_header"));
        assert!(says("a.off", b"OFF\n# a word\n3 1 0\n").contains("line 2: has a comment"));
        assert!(says("a.off", b"OFF\nx y z\n").contains("line 2"));
        let off = "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        assert_eq!(says("a.off", off.as_bytes()), "fine");
        assert!(says("a.off", off.replace("3 0 1 2", "-3 0 1 2").as_bytes()).contains("line 5"));
        assert!(says("a.off", off.replace("3 0 1 2", "3 0 1 3").as_bytes()).contains("line 5"));
        assert!(says("a.off", off.replace("3 0 1 2\n", "").as_bytes()).contains("1 faces, but ends after 0"));
        assert!(says("a.stl", b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n").contains("line 4"));
        assert!(
            says("a.stl", b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n")
                .contains("cut off at line 4")
        );
        assert!(says("a.stl", &[7; 100]).contains("bytes long, not 100"));
        assert!(says("a.stl", &[7; 10]).contains("10 bytes"));
        assert!(says("a.xyz", b"1 2 3").contains("ply, obj, stl or off"));
        assert!(says("a.PLY", b" \n").contains("empty"));
    }

    #[test]
    fn counts_that_a_file_cannot_hold_are_not_believed() {
        assert!(says("a.off", b"OFF\n99999999 3 0\n").contains("ends after 0"));
        let mut stl = vec![b' '; 80];
        stl.extend(u32::MAX.to_le_bytes());
        assert!(says("a.stl", &stl).contains("4294967295 triangles"));
    }
}
