//! Forces on the sheet: its own weight, and loads at points.

use super::{Curvature, Goal, Gradient, HessianSink, Moves, Part};
use crate::SheetPoint;
use glam::DVec3;
use softfold_geometry::{FlatMesh, TriangleId, VertexId};

/// `E = −Σ f·p`, N·mm, over points p of the sheet with constant forces f in N; Kangaroo's *Load*. The strength is the
/// force itself. A sheet that nothing holds against it has no equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Name for the report.
    pub name: String,
    /// Where forces act, and the forces, N.
    pub forces: Vec<(SheetPoint, DVec3)>,
}

/// Gravity at the earth's surface, m/s² (standard value, ISO 80000-3), downwards along z.
pub const EARTH_GRAVITY: DVec3 = DVec3::new(0.0, 0.0, -9.806_65);

/// kg of 1 mm³ at 1 kg/m³.
const KG_PER_MM3: f64 = 1e-9;

/// Motion of a vertex by one move of eq. 4 if nothing but the load acts, mm. It sets the move's weight |f|/step, small
/// against a sheet's stiffness; Kangaroo takes the weight 1 and the force as the step.
const LONE_STEP_MM: f64 = 1.0;

impl Load {
    /// The sheet's own weight: each triangle gives a third of `density × thickness × area × gravity` to each corner.
    /// Density in kg/m³, thickness in mm, gravity in m/s² (see [`EARTH_GRAVITY`]).
    pub fn self_weight(
        mesh: &FlatMesh,
        density_kg_per_m3: f64,
        thickness_mm: f64,
        gravity_m_per_s2: DVec3,
    ) -> Self {
        let mut area = vec![0.0; mesh.vertices.len()];
        for (t, corners) in mesh.triangles.iter().enumerate() {
            let third = mesh.triangle_area_mm2(TriangleId::new(t)) / 3.0;
            corners.iter().for_each(|v| area[v.index()] += third);
        }
        let per_area = density_kg_per_m3 * KG_PER_MM3 * thickness_mm * gravity_m_per_s2;
        let force = |(v, area): (usize, f64)| (SheetPoint::vertex(VertexId::new(v)), area * per_area);
        Self { name: "self weight".into(), forces: area.into_iter().enumerate().map(force).collect() }
    }

    /// A force in N at a point of the sheet.
    pub fn at(name: &str, point: SheetPoint, force_n: DVec3) -> Self {
        Self { name: name.to_owned(), forces: vec![(point, force_n)] }
    }

    /// Sum of the forces, N.
    pub fn total_n(&self) -> DVec3 {
        self.forces.iter().map(|f| f.1).sum()
    }
}

impl Goal for Load {
    fn name(&self) -> &str {
        &self.name
    }

    fn kind(&self) -> &'static str {
        "Load"
    }

    fn part(&self) -> Part {
        Part::Hold
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        Vec::new()
    }

    fn energy(&self, x: &[DVec3]) -> f64 {
        -self.forces.iter().map(|(p, f)| f.dot(p.position(x))).sum::<f64>()
    }

    fn add_gradient(&self, _: &[DVec3], out: &mut Gradient<'_>) {
        for (point, force) in &self.forces {
            point.corners().for_each(|(v, w)| out.add(v, -w * *force));
        }
    }

    fn add_hessian(&self, _: &[DVec3], _: Curvature, _: &mut HessianSink<'_>) {}

    fn add_moves(&self, _: &[DVec3], out: &mut Moves<'_>) {
        for (point, force) in &self.forces {
            let direction = LONE_STEP_MM * force.normalize_or_zero();
            point.corners().for_each(|(v, w)| out.add(v, w * force.length() / LONE_STEP_MM, direction));
        }
    }

    /// 0: a load has no aim.
    fn residual(&self, _: &[DVec3]) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::strip;

    #[test]
    fn the_weight_is_density_times_volume_times_gravity() {
        // 50 × 40 × 8 mm of 1600 kg/m³: 0.0256 kg.
        let load = Load::self_weight(&strip(5, 4, 10.0), 1600.0, 8.0, EARTH_GRAVITY);
        assert!((load.total_n() - DVec3::new(0.0, 0.0, -0.0256 * 9.80665)).length() < 1e-15);
    }

    #[test]
    fn lifting_the_sheet_costs_weight_times_height() {
        let mesh = strip(5, 4, 10.0);
        let load = Load::self_weight(&mesh, 1600.0, 8.0, EARTH_GRAVITY);
        let low: Vec<DVec3> = mesh.vertices.iter().map(|p| p.extend(0.0)).collect();
        let high: Vec<DVec3> = mesh.vertices.iter().map(|p| p.extend(100.0)).collect();
        let work = load.energy(&high) - load.energy(&low);
        assert!((work - 100.0 * 0.0256 * 9.80665).abs() < 1e-12);
    }
}
