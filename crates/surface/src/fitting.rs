//! One lattice fitted to the folded vertices, at any smoothing.

use crate::SurfaceError;
use crate::bending::{Smoothness, bending};
use crate::lattice::Lattice;
use crate::layout::{Cut, Layout};
use crate::open::opened;
use crate::poles::Poles;
use crate::samples::{Target, targets};
use crate::system::{Symmetric, System};
use glam::{DVec2, DVec3};
use softfold_geometry::{
    Deviation, EdgeClass, Extreme, FoldedSheet, PlanarCurve, ShellEdgeKind, UniformBicubic,
};
use softfold_kernel::opensubdiv::{self, Stencils};

/// Most steps of the multipliers (method of Hestenes and Powell, 1969).
const MOST_STEPS: usize = 12;
/// The distance must fall to this share in a step; where it does not, the faces cannot meet on this lattice, and larger
/// multipliers would only bend them.
const STEP_SHARE: f64 = 0.7;
/// Share of the allowed distance that is aimed at: between the places it is larger than at them.
const AIM: f64 = 0.3;
/// Places per cell at which the faces are held together: on one cell a bicubic on a curve is told by seven.
const GAP_PLACES: f64 = 8.0;

/// How firmly faces are held together along creases: the weight of their squared distance against that to the data, per area;
/// multipliers do the rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Firmness {
    /// Where the lattice cannot follow the crease, the faces part rather than ripple.
    Loose,
    /// They meet if any surface on the lattice lets them.
    Firm,
}

impl Firmness {
    fn weight(self) -> f64 {
        match self {
            Self::Loose => 1e6,
            Self::Firm => 1e9,
        }
    }
}

/// What is to be fitted: the same for all lattices.
pub(crate) struct Problem {
    pub(crate) layout: Layout,
    /// The vertices of the opened sheet, then the lifted points.
    targets: Vec<Target>,
    vertices: usize,
    /// The face of each target.
    faces: Vec<usize>,
    pub(crate) smoothness: Smoothness,
}

/// The least-squares problem of one lattice, ready to be solved for several bending weights.
pub(crate) struct Fitting<'a> {
    problem: &'a Problem,
    pub(crate) lattice: Lattice,
    pub(crate) poles: Poles,
    system: System,
    right: Vec<DVec3>,
    gaps: Vec<Gap>,
}

/// A place at which two faces shall meet: the difference of their points as a row over the unknowns, and its weight.
struct Gap {
    row: Vec<(u32, f64)>,
    weight_mm2: f64,
}

/// A solution and how far it is from the folded vertices.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    pub(crate) spacing_mm: f64,
    /// The lattice and the surface of every face.
    pub(crate) faces: Vec<(Lattice, UniformBicubic)>,
    pub(crate) deviation: Deviation,
    /// Largest distance of two faces along a crease that they share.
    pub(crate) gap_mm: Extreme,
}

/// A place on a crease, with the faces that meet there.
struct Meeting {
    uv: DVec2,
    faces: [usize; 2],
    weight_mm2: f64,
}

impl Problem {
    /// # Errors
    /// A trim that does not close.
    pub(crate) fn new(sheet: &FoldedSheet, trim: &[PlanarCurve], cuts: &[Cut]) -> Result<Self, SurfaceError> {
        let layout = Layout::new(trim, cuts)?;
        let open = opened(sheet, cuts);
        let targets = targets(&open);
        let face = |t: &Target| if layout.faces.len() == 1 { 0 } else { layout.face_of(t.beside) };
        let faces = targets.iter().map(face).collect();
        let smoothness = match layout.faces.len() > 1 && !has_bands(&open) {
            true => Smoothness::ChangeOfCurvature,
            false => Smoothness::Curvature,
        };
        Ok(Self { layout, vertices: open.positions.len(), faces, targets, smoothness })
    }

    /// Places along the creases, `phase` of a step from their starts.
    fn meetings(&self, spacing_mm: f64, phase: f64) -> Vec<Meeting> {
        let mut places = Vec::new();
        for (edge, sides) in self.layout.edges.iter().zip(&self.layout.sides) {
            let (ShellEdgeKind::Crease, [Some(a), Some(b)]) = (edge.kind, *sides) else { continue };
            let length = edge.segment.length_mm();
            let n = (GAP_PLACES * length / spacing_mm).ceil().max(2.0);
            let last = if phase == 0.0 { n as usize } else { n as usize - 1 };
            places.extend((0..=last).map(|k| Meeting {
                uv: edge.segment.at((k as f64 + phase) / n),
                faces: [a, b],
                weight_mm2: spacing_mm * length / n,
            }));
        }
        places
    }
}

impl<'a> Fitting<'a> {
    /// Sets up `Σ Aᵢ |S(uᵢ) − pᵢ|²` over the targets, a row of OpenSubdiv's limit stencils each, and the distances of faces
    /// that share a crease.
    ///
    /// # Errors
    /// OpenSubdiv's or the solver's refusal.
    pub(crate) fn new(problem: &'a Problem, lattice: Lattice, margin: u32) -> Result<Self, SurfaceError> {
        let poles = Poles::new(lattice, &problem.layout, margin);
        let meetings = problem.meetings(lattice.spacing_mm, 0.0);
        let places = problem.targets.iter().map(|t| t.uv).chain(meetings.iter().map(|m| m.uv));
        let samples: Vec<_> = places.map(|uv| lattice.sample(uv)).collect();
        let stencils = opensubdiv::limit_stencils(&lattice.connections(), &samples)?;
        let mut data = Symmetric::zero(poles.count);
        let mut right = vec![DVec3::ZERO; poles.count];
        for (i, (target, &face)) in problem.targets.iter().zip(&problem.faces).enumerate() {
            let row = poles.row(face, row(&stencils, i));
            data.add_row(&row, target.weight_mm2);
            row.iter().for_each(|&(pole, w)| right[pole as usize] += target.weight_mm2 * w * target.position);
        }
        let (mut gaps, mut apart) = (Vec::with_capacity(meetings.len()), Symmetric::zero(poles.count));
        for (i, meeting) in meetings.iter().enumerate() {
            let [a, b] = meeting.faces.map(|f| poles.row(f, row(&stencils, problem.targets.len() + i)));
            let gap = Gap { row: difference(&a, &b), weight_mm2: meeting.weight_mm2 };
            apart.add_row(&gap.row, gap.weight_mm2);
            gaps.push(gap);
        }
        let bending = bending(&poles, lattice.spacing_mm, problem.smoothness);
        let system = System::new([&data, &bending, &apart]).map_err(|cause| unsolved(&lattice, cause))?;
        Ok(Self { problem, lattice, poles, system, right, gaps })
    }

    /// The surface that minimises data term plus `bending_weight` times the bending term, faces that share creases meeting
    /// there as nearly as `gap_mm` if the lattice lets them.
    ///
    /// # Errors
    /// The equations cannot be solved.
    pub(crate) fn solve(
        &self,
        bending_weight: f64,
        firmness: Firmness,
        gap_mm: f64,
    ) -> Result<Solution, SurfaceError> {
        let weight = firmness.weight();
        let factors = [1.0, bending_weight, weight];
        let factor = self.system.factor(factors).map_err(|cause| unsolved(&self.lattice, cause))?;
        let solution = self.meet(|right| self.system.solve(&factor, right), weight, AIM * gap_mm);
        let face = |f: usize| (self.poles.lattice_of(f), self.poles.spline(f, &solution));
        let faces: Vec<_> = (0..self.poles.faces()).map(face).collect();
        faces.iter().try_for_each(|(_, s)| s.check()).map_err(|e| unsolved(&self.lattice, e.fault))?;
        Ok(Solution {
            spacing_mm: self.lattice.spacing_mm,
            deviation: self.deviation(&faces),
            gap_mm: self.gap_mm(&faces),
            faces,
        })
    }

    /// Multipliers of the distances are raised, solve by solve, until the faces meet or come no nearer.
    fn meet(&self, solve: impl Fn(&[DVec3]) -> Vec<DVec3>, weight: f64, aim_mm: f64) -> Vec<DVec3> {
        let mut right = self.right.clone();
        let mut x = solve(&right);
        let mut before = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let apart: Vec<DVec3> = self.gaps.iter().map(|g| g.of(&x)).collect();
            let largest = apart.iter().map(|d| d.length()).fold(0.0, f64::max);
            if largest <= aim_mm || largest > STEP_SHARE * before {
                break;
            }
            before = largest;
            for (gap, d) in self.gaps.iter().zip(apart) {
                gap.row
                    .iter()
                    .for_each(|&(unknown, w)| right[unknown as usize] -= weight * gap.weight_mm2 * w * d);
            }
            x = solve(&right);
        }
        x
    }

    /// Distance of each folded vertex to the surface's point of the same (u, v): never less than the distance to the
    /// surface itself. The root mean square counts every vertex alike.
    fn deviation(&self, faces: &[(Lattice, UniformBicubic)]) -> Deviation {
        let mut worst = Deviation::default();
        let mut squares = 0.0;
        let vertices = &self.problem.targets[..self.problem.vertices];
        for (target, &face) in vertices.iter().zip(&self.problem.faces) {
            let distance = faces[face].1.at(target.uv).position.distance(target.position);
            squares += distance * distance;
            if distance > worst.max_mm {
                worst = Deviation { max_mm: distance, at: target.uv, ..worst };
            }
        }
        Deviation { rms_mm: (squares / vertices.len().max(1) as f64).sqrt(), ..worst }
    }

    /// Between the places at which the faces were held together.
    fn gap_mm(&self, faces: &[(Lattice, UniformBicubic)]) -> Extreme {
        let mut worst = Extreme::default();
        for Meeting { uv, faces: sides, .. } in self.problem.meetings(self.lattice.spacing_mm, 0.5) {
            let [a, b] = sides.map(|f| faces[f].1.at(uv).position);
            if a.distance(b) > worst.value {
                worst = Extreme { value: a.distance(b), at: uv };
            }
        }
        worst
    }
}

impl Gap {
    fn of(&self, x: &[DVec3]) -> DVec3 {
        self.row.iter().map(|&(unknown, w)| w * x[unknown as usize]).sum()
    }
}

/// Whether soft bands are left where sharp creases are opened.
fn has_bands(open: &FoldedSheet) -> bool {
    open.mesh.edges.iter().any(|e| matches!(e.class, EdgeClass::Fold { turn_rad, .. } if turn_rad != 0.0))
}

fn row(stencils: &Stencils, i: usize) -> impl Iterator<Item = (u32, f64)> {
    let range = stencils.offsets[i] as usize..stencils.offsets[i + 1] as usize;
    range.map(|k| (stencils.indices[k], stencils.weights[k]))
}

/// `a − b`, each unknown once.
fn difference(a: &[(u32, f64)], b: &[(u32, f64)]) -> Vec<(u32, f64)> {
    let mut row = a.to_vec();
    for &(unknown, w) in b {
        match row.iter_mut().find(|r| r.0 == unknown) {
            Some(entry) => entry.1 -= w,
            None => row.push((unknown, -w)),
        }
    }
    row.retain(|r| r.1 != 0.0);
    row
}

fn unsolved(lattice: &Lattice, cause: String) -> SurfaceError {
    SurfaceError::Factorisation { spacing_mm: lattice.spacing_mm, cause }
}
