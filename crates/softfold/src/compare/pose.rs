//! A pose as a user gives it.

use super::rigid;
use crate::RunError;
use softfold_geometry::{DMat3, DVec3, RigidTransform};

/// How far the rows of a given rotation may be from orthonormal: three printed digits.
const SLACK: f64 = 5e-3;

/// Reads `x y z rx ry rz` (a shift in mm after turns about the fixed axes x, y, z in this order, degrees), or the rows of
/// a 3×4 or 4×4 matrix, which compare.json and CloudCompare give; separated by blanks or commas.
///
/// # Errors
/// Another number of numbers, or a matrix that is no rotation.
pub fn pose(text: &str) -> Result<RigidTransform, RunError> {
    let refuse = |what: String| {
        RunError::Input(format!(
            "--pose {what}; give \"x y z rx ry rz\" in mm and degrees, or the 12 or 16 numbers of a matrix by rows"
        ))
    };
    let words = text.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty());
    let number =
        |w: &str| w.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| refuse(format!("has {w:?}")));
    let numbers = words.map(number).collect::<Result<Vec<f64>, _>>()?;
    match numbers[..] {
        [x, y, z, rx, ry, rz] => {
            Ok(RigidTransform { rotation: turned(rx, ry, rz), translation: DVec3::new(x, y, z) })
        }
        ref m if m.len() == 12 || (m.len() == 16 && m[12..] == [0.0, 0.0, 0.0, 1.0]) => {
            let row = |r: usize| DVec3::new(m[4 * r], m[4 * r + 1], m[4 * r + 2]);
            let rows = DMat3::from_cols(row(0), row(1), row(2));
            let off = rows * rows.transpose() - DMat3::IDENTITY;
            if off.to_cols_array().iter().any(|x| x.abs() > SLACK) || rows.determinant() < 0.0 {
                return Err(refuse("is no rotation with a shift: it scales, shears or mirrors".to_owned()));
            }
            let translation = DVec3::new(m[3], m[7], m[11]);
            Ok(RigidTransform { rotation: rigid::orthonormal(rows.transpose()), translation })
        }
        ref m if m.len() == 16 => Err(refuse("has a last row that is not 0 0 0 1".to_owned())),
        ref m => Err(refuse(format!("has {} numbers", m.len()))),
    }
}

fn turned(rx: f64, ry: f64, rz: f64) -> DMat3 {
    DMat3::from_rotation_z(rz.to_radians())
        * DMat3::from_rotation_y(ry.to_radians())
        * DMat3::from_rotation_x(rx.to_radians())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_and_matrices_are_read() {
        let by_turns = pose("10, 20, 30, 0, 0, 90").unwrap();
        assert!(by_turns.point(DVec3::X).distance(DVec3::new(10.0, 21.0, 30.0)) < 1e-12);
        let by_rows = pose("0 -1 0 10  1 0 0 20  0 0 1 30  0 0 0 1").unwrap();
        assert!(by_rows.point(DVec3::X).distance(by_turns.point(DVec3::X)) < 1e-12);
        let both = pose("0 0 0 90 0 90").unwrap();
        assert!(both.point(DVec3::Y).distance(DVec3::Z) < 1e-12); // about x first
    }

    #[test]
    fn what_is_no_pose_is_refused_with_a_mend() {
        for text in [
            "",
            "1 2 3",
            "a b c d e f",
            "1 0 0 0 0 1 0 0 0 0 -1 0",
            "2 0 0 0 0 2 0 0 0 0 2 0",
            "nan 0 0 0 0 0",
        ] {
            let said = pose(text).unwrap_err().to_string();
            assert!(said.contains("--pose") && said.contains("give"), "{text}: {said}");
        }
    }
}
