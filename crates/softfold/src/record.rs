//! From results to the report: figures as they are, and verdicts against the project's limits.

use crate::report::json;
use crate::shape::radius_limit_mm;
use crate::stages::{AnalyseResult, FoldResult, Loaded, MeshResult, Results, SubdResult, SurfaceResult};
use crate::states::{SpringBack, State};
use softfold_fold::Clearance;
use softfold_geometry::{
    Band, Crease, CreasePattern, DVec2, DVec3, SheetShell, ShellEdgeKind, SoftPattern, Softness,
};
use softfold_mesh::Crosscheck;
use softfold_mold::{Board, Mold, Rest};
use softfold_soften::BandFigures;
use softfold_surface::subd::JoinAngle;
use softfold_surface::{CutKind, FittedShell};

/// The report of a run; its list of files is empty.
pub fn report(loaded: &Loaded, results: &Results) -> json::Report {
    let mut report = json::Report::new(pattern(results));
    report.mesh = results.mesh.as_ref().map(mesh);
    report.fold = results.fold.as_ref().map(|f| fold(results, f));
    report.analyse = results.analyse.as_ref().map(|a| analyse(loaded, results, a));
    report.surface = results.surface.as_ref().map(|s| surface(results, s));
    report.board = results.board.as_ref().map(board);
    report.stability = results.stability.as_ref().map(|s| stability(results, s));
    report.mold = results.mold.as_ref().map(|m| mold(results, m));
    report.verdicts = verdicts(loaded, results);
    report.stages = results
        .seconds
        .iter()
        .map(|(name, seconds)| json::Stage { name: (*name).to_owned(), seconds: *seconds })
        .collect();
    report
}

fn pair(p: DVec2) -> [f64; 2] {
    p.to_array()
}

fn triple(p: DVec3) -> [f64; 3] {
    p.to_array()
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn pattern(results: &Results) -> json::Pattern {
    let Some(pattern) = &results.pattern else { return json::Pattern::default() };
    json::Pattern {
        name: pattern.name.clone(),
        creases: creases(pattern, results.soft.as_ref()),
        area_mm2: pattern.area_mm2(),
        issues: results.issues.iter().map(json::Issue::from).collect(),
    }
}

fn creases(pattern: &CreasePattern, soft: Option<&SoftPattern>) -> Vec<json::Crease> {
    let one = |(i, c): (usize, &Crease)| {
        let band = soft.and_then(|s| s.bands.get(i));
        let steepest = band.and_then(Band::steepest);
        let widest = band.and_then(|b| Some(BandFigures::of(&widest(b)?, b.segments)));
        json::Crease {
            name: c.name.clone(),
            role: c.role.letter().to_string(),
            length_mm: c.curve.length_mm(),
            fold_angle_deg: steepest.map_or(0.0, |s| s.fold_angle_rad.to_degrees()),
            radius_mm: band.and_then(Band::softest).map_or(0.0, |s| s.radius_mm),
            segments: widest.map_or(0, |b| b.segments),
            chord_mm: widest.map_or(0.0, |b| b.chord_mm),
            band_width_mm: widest.map_or(0.0, |b| b.band_width_mm),
            arc_mm: widest.map_or(0.0, |b| b.arc_length_mm),
            profile: band.filter(|b| b.profile.len() > 1).map(profile).unwrap_or_default(),
        }
    };
    pattern.creases.iter().enumerate().map(one).collect()
}

/// The entry of a band's profile where it is widest.
fn widest(band: &Band) -> Option<Softness> {
    let width = |s: &Softness| s.strip_width_mm(band.segments);
    band.profile.iter().copied().reduce(|a, b| if width(&b) > width(&a) { b } else { a })
}

fn profile(band: &Band) -> Vec<json::Softness> {
    let one = |s: &Softness| json::Softness {
        s_mm: s.s_mm,
        radius_mm: s.radius_mm,
        fold_angle_deg: s.fold_angle_rad.to_degrees(),
    };
    band.profile.iter().map(one).collect()
}

fn mesh(m: &MeshResult) -> json::Mesh {
    json::Mesh {
        vertices: m.meshed.mesh.vertices.len(),
        triangles: m.meshed.mesh.triangles.len(),
        min_angle_deg: m.quality.min_angle_deg,
        median_min_angle_deg: m.quality.median_min_angle_deg,
        own_min_angle_deg: m.meshed.inspection.free.min_angle_deg,
        sharp_places: m.meshed.inspection.places.len(),
        sharp_triangles: m.meshed.inspection.excused,
        chord_mm: m.meshed.inspection.fold_chord_mm.max(m.meshed.inspection.boundary_chord_mm),
        backend: m.backend.name().to_owned(),
        crosscheck: Some(json::Crosscheck::from(&m.crosscheck)),
    }
}

impl From<&Crosscheck> for json::Crosscheck {
    fn from(c: &Crosscheck) -> Self {
        Self {
            constraints_held: c.constraints_held,
            area_relative_difference: c.area_relative_difference,
            cocircular_differences: c.cocircular_differences.len(),
            other_differences: c.other_differences.len(),
        }
    }
}

fn level(l: &softfold_geometry::LevelRecord) -> json::Level {
    json::Level { vertices: l.vertices, iterations: l.iterations, factorisations: l.factorisations }
}

fn fold(results: &Results, f: &FoldResult) -> json::Fold {
    let solve = &f.sheet.solve;
    let goal = |g: &crate::stages::GoalFigure| json::Goal {
        name: g.name.clone(),
        kind: g.kind.to_owned(),
        energy: g.energy,
        residual_mm: (!["Hinge", "Plate"].contains(&g.kind)).then_some(g.residual),
    };
    let mut fold = json::Fold {
        solver: solve.solver.clone(),
        iterations: solve.iterations,
        factorisations: solve.factorisations,
        levels: solve.levels.iter().map(level).collect(),
        seconds: results.seconds.iter().find(|s| s.0 == "fold").map_or(0.0, |s| s.1),
        energy: solve.energy,
        relative_gradient: solve.relative_gradient,
        converged: solve.converged,
        stop: solve.stop.clone(),
        hoop_estimate: hoop_estimate(results),
        goals: f.goals.iter().map(goal).collect(),
        states: f.states.iter().map(state).collect(),
        spring_back: f.spring_back.iter().map(spring_back).collect(),
        ..json::Fold::default()
    };
    if let Some(a) = &results.analyse {
        let v = &a.verdict;
        fold.max_edge_strain = v.max_edge_strain.value;
        [fold.area_error_min, fold.area_error_max] = v.area_error.map(|e| e.value);
        [fold.area_error_min_at, fold.area_error_max_at] = v.area_error.map(|e| pair(e.at));
        fold.turn_error_max_deg = v.max_turn_error_rad.value.to_degrees();
        fold.self_intersections = a.self_intersections;
    }
    fold
}

fn state(s: &State) -> json::State {
    let solve = &s.sheet.solve;
    let (iterations, energy, converged) = (solve.iterations, solve.energy, solve.converged);
    json::State { name: s.name.clone(), iterations, energy, converged }
}

fn spring_back(s: &SpringBack) -> json::SpringBack {
    json::SpringBack {
        crease: s.crease.clone(),
        reached_deg: s.reached_rad.to_degrees(),
        rest_deg: s.rest_rad.to_degrees(),
        released_deg: s.released_rad.to_degrees(),
    }
}

/// Places along a crease at which its curvature is looked at.
const CURVATURE_SAMPLES: u32 = 400;

/// Largest hoop strain ± δ/(2R) over the creases, shared by both sides of the band: δ = 2 r (sin α − α cos α), 2α the
/// fold angle, and R = cos α / κ the crease's radius in space where its flat curvature κ is largest.
fn hoop_estimate(results: &Results) -> Option<f64> {
    let (pattern, soft) = (results.pattern.as_ref()?, results.soft.as_ref()?);
    let estimate = |(crease, band): (&Crease, &Band)| {
        let at = |k: u32| crease.curve.length_mm() * f64::from(k) / f64::from(CURVATURE_SAMPLES);
        let flat = (0..=CURVATURE_SAMPLES).map(|k| crease.curve.curvature(at(k)).abs()).fold(0.0, f64::max);
        let strain = |s: &Softness| shared_hoop_strain(s.radius_mm, s.fold_angle_rad, flat);
        band.profile.iter().map(strain).fold(0.0, f64::max)
    };
    let largest = pattern.creases.iter().zip(&soft.bands).map(estimate).fold(0.0, f64::max);
    (largest > 0.0).then_some(largest)
}

fn shared_hoop_strain(radius_mm: f64, fold_angle_rad: f64, flat_curvature: f64) -> f64 {
    let alpha = 0.5 * fold_angle_rad.abs();
    let excess_mm = 2.0 * radius_mm * (alpha.sin() - alpha * alpha.cos());
    0.5 * excess_mm * flat_curvature / alpha.cos()
}

fn analyse(loaded: &Loaded, results: &Results, a: &AnalyseResult) -> json::Analyse {
    let v = &a.verdict;
    let on_surface = results.surface.as_ref().map(|s| &s.analysis.min_radius_mm);
    let (radius, at) =
        on_surface.map_or((v.min_bend_radius_mm.value, v.min_bend_radius_mm.at), |r| (r.value, r.at));
    json::Analyse {
        min_bend_radius_mm: finite(radius),
        min_bend_radius_at: pair(at),
        max_fibre_strain: 0.5 * loaded.project.board.thickness_mm / radius,
        max_angle_defect_rad: v.max_angle_defect_rad.value,
        principal_strain_min: v.principal_strain[0].value,
        principal_strain_max: v.principal_strain[1].value,
        self_distance_mm: a.clearance.map(|c| c.distance_mm),
        self_distance_at: a.clearance.map(|c| c.at.map(pair)),
    }
}

fn surface(results: &Results, s: &SurfaceResult) -> json::Surface {
    let (deviation, one) = (s.deviation(), s.fitted.as_ref().map(|f| (f.surface.spline.count, f.spacing_mm)));
    let several = s.shell.as_ref().map(|f| (most_poles(&f.shell), f.spacing_mm));
    let (poles, spacing_mm) = several.or(one).unwrap_or_default();
    json::Surface {
        faces: s.faces(),
        poles,
        spacing_mm,
        max_deviation_mm: deviation.max_mm,
        rms_deviation_mm: deviation.rms_mm,
        max_deviation_at: pair(deviation.at),
        face_distance_mm: s.face_distance_mm,
        valid: s.all_faults().is_empty(),
        shell: s.shell.as_ref().map(|f| shell(results, f, s.edge_tolerance_mm)),
        shape: Some(s.shape.figures(&s.analysis)),
        cage: s.subd.as_ref().map(cage),
    }
}

fn most_poles(shell: &SheetShell) -> [usize; 2] {
    let counts = shell.faces.iter().map(|f| f.spline.count);
    counts.max_by_key(|[u, v]| u * v).unwrap_or_default()
}

fn shell(results: &Results, fitted: &FittedShell, edge_tolerance_mm: f64) -> json::Shell {
    let shell = &fitted.shell;
    json::Shell {
        creases: shell.count(ShellEdgeKind::Crease),
        smooth_edges: shell.count(ShellEdgeKind::Smooth),
        slit_lips: shell.count(ShellEdgeKind::Slit),
        poles: shell.faces.iter().map(|f| f.spline.poles.len()).sum(),
        gap_mm: shell.gap_mm.value,
        gap_at: pair(shell.gap_mm.at),
        edge_tolerance_mm,
        rounded: fitted.lost.iter().map(|cut| cut_name(results, cut)).collect(),
    }
}

fn cut_name(results: &Results, cut: &CutKind) -> String {
    match cut {
        CutKind::Slit => "a slit".to_owned(),
        CutKind::Crease { crease, .. } => {
            let name = results.pattern.as_ref().and_then(|p| p.creases.get(crease.index())).map(|c| &c.name);
            name.cloned().unwrap_or_else(|| format!("crease {crease}"))
        }
    }
}

fn cage(s: &SubdResult) -> json::Cage {
    let (made, q) = (&s.made, &s.made.quality);
    let irregular = q.irregular.iter().map(|&(at, valence)| json::Irregular { at: pair(at), valence });
    let excused = q.excused.iter().map(|e| placed_angle(e.at, e.angle_rad));
    let degrees = |j: Option<JoinAngle>| j.map(|j| j.angle_rad.to_degrees());
    json::Cage {
        quads: q.quads,
        inner_vertices: q.inner_vertices,
        valence_4_share: q.valence_4_share(),
        irregular: irregular.collect(),
        min_angle_deg: q.min_angle_rad.to_degrees(),
        min_angle_at: pair(q.min_angle_at),
        excused: excused.collect(),
        rows_along_bands: q.rows_along_bands,
        cell_mm: made.cell_mm,
        cells_per_strip: made.cells_per_strip,
        border_mm: made.border_mm,
        patches: made.patches,
        faces: made.surface.faces.len(),
        gap_mm: s.gap_mm,
        g1_regular_deg: degrees(made.joins.regular),
        g1_irregular_deg: degrees(made.joins.irregular),
        rough: made.joins.rough.iter().map(|j| placed_angle(j.at, j.angle_rad)).collect(),
    }
}

fn placed_angle(at: DVec2, angle_rad: f64) -> json::PlacedAngle {
    json::PlacedAngle { at: pair(at), angle_deg: angle_rad.to_degrees() }
}

fn board(b: &Board) -> json::Board {
    json::Board {
        thickness_mm: b.thickness_mm,
        volume_mm3: b.volume_mm3,
        area_mm2: b.area_mid_mm2,
        area_times_thickness_mm3: b.area_mid_mm2 * b.thickness_mm,
        mass_kg: b.mass_kg,
        barycenter_mm: triple(b.barycenter_mm),
        inertia_kg_mm2: b.inertia.tensor_kg_mm2.transpose().to_cols_array_2d(),
        principal_moments_kg_mm2: b.inertia.principal_kg_mm2,
        principal_axes: b.inertia.axes.map(triple),
        offset_volume_mm3: b.offset_volume_mm3,
        mesh_volume_mm3: b.mesh_volume_mm3,
        trimmed_mm3: b.trimmed.map(|t| t.removed_mm3),
        min_radius_mm: finite(b.min_radius_mm.iter().map(|r| r.radius_mm).fold(f64::INFINITY, f64::min)),
        offset_error_mm: b.offset_error_mm,
        // make_board refuses a solid that is not valid.
        valid: true,
    }
}

fn stability(results: &Results, rest: &Rest) -> json::Stability {
    let s = &rest.stability;
    let highest =
        results.fold.iter().flat_map(|f| &f.sheet.positions).map(|p| rest.rest_from_pose.point(*p).z);
    let highest = highest.fold(f64::MIN, f64::max);
    json::Stability {
        stable: s.stable,
        margin_mm: s.margin_mm,
        tipping_angle_deg: s.tipping_angle_deg,
        tipping_push_n: results.board.as_ref().map_or(0.0, |b| s.tipping_push_n(b.mass_kg)),
        barycenter_mm: triple(s.barycenter_mm),
        hull: s.hull.iter().map(|p| pair(*p)).collect(),
        contact_points: s.contact_points,
        height_mm: highest - s.ground_z_mm,
        support_margin_mm: rest.support_margin_mm,
        tilt_deg: rest.tilt_deg,
    }
}

fn mold(results: &Results, m: &Mold) -> json::Mold {
    let pose = &m.pose.mold_from_sheet;
    json::Mold {
        volume_mm3: m.volume_mm3,
        mesh_volume_mm3: results.mold_mesh_volume_mm3,
        pose_rotation: pose.rows(),
        pose_translation_mm: triple(pose.translation),
        height_mm: m.parts.iter().flat_map(|p| &p.solid.positions).map(|p| p.z).fold(0.0, f64::max),
        least_draft_deg: m.pose.least_draft_deg,
        undercuts: m.pose.undercuts.len(),
        parts: m.parts.iter().map(part).collect(),
        boards: m.waffle.boards.iter().map(waffle_board).collect(),
        sheets: m.waffle.nest.sheets.len(),
        stock_use: m.waffle.nest.use_fraction,
    }
}

fn part(p: &softfold_mold::Part) -> json::Part {
    json::Part {
        name: p.name.clone(),
        volume_mm3: p.volume_mm3,
        cell_volume_mm3: p.exact_volume_mm3,
        size_mm: triple(p.size_mm),
        valid: p.valid,
        inner: p.inner,
        faults: p.faults.clone(),
    }
}

fn waffle_board(b: &softfold_mold::WaffleBoard) -> json::WaffleBoard {
    json::WaffleBoard { name: b.name.clone(), length_mm: b.size_mm.x, height_mm: b.size_mm.y }
}

/// One verdict.
fn verdict(
    name: &str,
    pass: bool,
    figure: Option<f64>,
    limit: Option<f64>,
    unit: &str,
    message: String,
) -> json::Verdict {
    json::Verdict { name: name.to_owned(), pass, figure, limit, unit: unit.to_owned(), message }
}

fn verdicts(loaded: &Loaded, results: &Results) -> Vec<json::Verdict> {
    let mut all = Vec::new();
    results.mesh.iter().for_each(|m| all.push(mesh_verdict(m)));
    results.fold.iter().for_each(|f| all.push(rest_verdict(f)));
    results.analyse.iter().for_each(|a| all.extend(sheet_verdicts(loaded, a)));
    results.surface.iter().for_each(|s| all.extend(surface_verdicts(loaded, s)));
    results.board.iter().for_each(|b| all.extend(radius_verdict(loaded, b)));
    results.board.iter().for_each(|b| all.push(volume_verdict(b)));
    results.stability.iter().for_each(|s| all.push(stability_verdict(loaded, s)));
    results.mold.iter().for_each(|m| all.extend(mold_verdicts(results, m)));
    all
}

fn mesh_verdict(m: &MeshResult) -> json::Verdict {
    let message = match m.crosscheck.agrees() {
        true => "spade and CGAL make the same mesh of the pattern".to_owned(),
        false => "spade and CGAL disagree on the mesh; run `softfold crosscheck` for the places".to_owned(),
    };
    let others = m.crosscheck.other_differences.len() as f64;
    verdict("mesh cross-check", m.crosscheck.agrees(), Some(others), Some(0.0), "", message)
}

fn rest_verdict(f: &FoldResult) -> json::Verdict {
    let solve = &f.sheet.solve;
    let message = match solve.converged {
        true => "the folded sheet is at rest".to_owned(),
        false => format!("the folded sheet is not at rest ({}); raise fold.max_iterations", solve.stop),
    };
    verdict("equilibrium", solve.converged, Some(solve.relative_gradient), None, "", message)
}

fn sheet_verdicts(loaded: &Loaded, a: &AnalyseResult) -> [json::Verdict; 3] {
    let limit = loaded.project.limits.area_error;
    let worst = a
        .verdict
        .area_error
        .into_iter()
        .max_by(|x, y| x.value.abs().total_cmp(&y.value.abs()))
        .unwrap_or_default();
    let pass = worst.value.abs() <= limit;
    let place = format!("at ({:.0}, {:.0}) mm on the sheet", worst.at.x, worst.at.y);
    let message = match pass {
        true => format!("the sheet keeps its area; the largest change is {place}"),
        false => format!(
            "the sheet is stretched or pressed too much {place}; fold less, use a smaller radius or a weaker hold"
        ),
    };
    let hits = a.self_intersections;
    let through = match hits {
        0 => "no part of the sheet passes through another".to_owned(),
        n => format!("{n} pairs of triangles pass through each other; fold less or move the creases apart"),
    };
    [
        verdict("area error", pass, Some(100.0 * worst.value), Some(100.0 * limit), "%", message),
        verdict("self-intersection", hits == 0, Some(hits as f64), Some(0.0), "", through),
        distance_verdict(loaded.project.board.thickness_mm, a.clearance.as_ref()),
    ]
}

/// Two places of the middle of the sheet that are nearer than its thickness: the board is in the way of itself.
fn distance_verdict(thickness_mm: f64, clearance: Option<&Clearance>) -> json::Verdict {
    let pass = clearance.is_none_or(|c| c.distance_mm >= thickness_mm);
    let message = match clearance {
        None => "the sheet keeps far from itself".to_owned(),
        Some(c) => {
            let [p, q] = c.at;
            let places = format!("({:.0}, {:.0}) and ({:.0}, {:.0}) mm on the sheet", p.x, p.y, q.x, q.y);
            match pass {
                true => format!("the sheet keeps its thickness from itself; nearest are {places}"),
                false => format!(
                    "{places} are nearer to each other than the sheet is thick; fold less, use larger radii, or leave \
                     fold.self_collision on"
                ),
            }
        }
    };
    let figure = clearance.map(|c| c.distance_mm);
    verdict("self-distance", pass, figure, Some(thickness_mm), "mm", message)
}

fn surface_verdicts(loaded: &Loaded, s: &SurfaceResult) -> Vec<json::Verdict> {
    let limit = loaded.project.limits.surface_deviation_mm;
    let d = s.deviation();
    let place = format!("({:.0}, {:.0}) mm on the sheet", d.at.x, d.at.y);
    let pass = d.max_mm <= limit;
    let message = match pass {
        true => format!("the surface follows the folded sheet; it is farthest at {place}"),
        false => {
            format!("the surface leaves the folded sheet at {place}; give a smaller surface.tolerance_mm")
        }
    };
    let faults = s.all_faults();
    let what = if s.subd.is_some() { "shell" } else { "trimmed face" };
    let face = match faults.is_empty() {
        true => format!("OpenCascade finds the {what} valid"),
        false => format!("OpenCascade finds the {what} faulty: {}", faults.join("; ")),
    };
    let mut all = vec![
        verdict("surface deviation", pass, Some(d.max_mm), Some(limit), "mm", message),
        verdict("surface validity", faults.is_empty(), None, None, "", face),
    ];
    all.extend(s.shell.as_ref().map(watertight_verdict));
    all
}

/// Faces that share an edge must be one curve there, and every sharp crease must be such an edge.
fn watertight_verdict(fitted: &FittedShell) -> json::Verdict {
    let gap = fitted.shell.gap_mm;
    let place = format!("at ({:.0}, {:.0}) mm on the sheet", gap.at.x, gap.at.y);
    let message = match (fitted.watertight, fitted.lost.is_empty()) {
        (true, true) => format!("faces meet along all sharp creases; they are farthest apart {place}"),
        (true, false) => format!(
            "{} sharp creases or slits bound no face and are rounded; lead them to the outline or to another crease",
            fitted.lost.len()
        ),
        (false, _) => format!(
            "faces part along a crease {place}; draw it there without a jump of its curvature, or give a smaller surface.spacing_mm"
        ),
    };
    let pass = fitted.watertight && fitted.lost.is_empty();
    verdict("surface seams", pass, Some(gap.value), Some(FittedShell::GAP_MM), "mm", message)
}

fn radius_verdict(loaded: &Loaded, b: &Board) -> Option<json::Verdict> {
    let limit = radius_limit_mm(&loaded.project)?;
    let tightest = b.min_radius_mm.iter().min_by(|x, y| x.radius_mm.total_cmp(&y.radius_mm))?;
    let pass = tightest.radius_mm >= limit;
    let place = format!("({:.0}, {:.0}) mm on the sheet", tightest.at.x, tightest.at.y);
    let message = match pass {
        true => format!("the material can bend as tightly as it must; tightest at {place}"),
        false => format!(
            "a skin bends tighter than the material can at {place}; raise soften.radius_mm or use a thinner board"
        ),
    };
    Some(verdict("bend radius", pass, Some(tightest.radius_mm), Some(limit), "mm", message))
}

/// A board's volume and that of its triangles may differ by this share: the chord error of the triangles.
const BOARD_VOLUME_SHARE: f64 = 1e-3;

fn volume_verdict(b: &Board) -> json::Verdict {
    let whole = b.volume_mm3 + b.trimmed.map_or(0.0, |t| t.removed_mm3);
    let apart = (b.mesh_volume_mm3 / whole - 1.0).abs();
    let pass = apart <= BOARD_VOLUME_SHARE;
    let message = match pass {
        true => "the exact board and CGAL's solid of its triangles have the same volume".to_owned(),
        false => "the exact board and CGAL's solid of its triangles differ in volume: look at board.step where it bends most"
            .to_owned(),
    };
    verdict("board volume", pass, Some(100.0 * apart), Some(100.0 * BOARD_VOLUME_SHARE), "%", message)
}

fn stability_verdict(loaded: &Loaded, rest: &Rest) -> json::Verdict {
    let s = &rest.stability;
    let limit = loaded.project.limits.stability_margin_mm;
    // Feet within the contact tolerance count: a piece that rocks onto its next foot has not fallen.
    let pass = s.stable && s.margin_mm >= limit;
    let message = match (s.stable, pass) {
        (true, true) => {
            format!("the piece stands by itself; it falls when it is tipped by {:.1}°", s.tipping_angle_deg)
        }
        (true, false) => "the piece stands, but with less margin than asked; widen its foot".to_owned(),
        (false, _) => "as it is folded the piece does not stand; widen its foot, bring its barycenter over it, or hold it in \
                       another pose"
            .to_owned(),
    };
    verdict("stability", pass, Some(s.margin_mm), Some(limit), "mm", message)
}

/// Volumes of the exact mold and of its triangles may differ by this share: the chord error of the triangles.
const VOLUME_SHARE: f64 = 5e-4;

/// A board without a slot crosses no other and cannot stand by itself.
fn waffle_verdict(m: &Mold) -> json::Verdict {
    let boards = &m.waffle.boards;
    let loose: Vec<&str> = boards.iter().filter(|b| b.slots_mm.is_empty()).map(|b| b.name.as_str()).collect();
    let pass = !boards.is_empty() && loose.is_empty();
    let message = match (boards.is_empty(), loose.is_empty()) {
        (true, _) => "no board fits below the mold; give a smaller waffle.pitch_mm".to_owned(),
        (_, true) => format!("all {} boards cross another and stand", boards.len()),
        _ => format!(
            "boards {} cross no other: fix them by hand, or change waffle.pitch_mm or angle_deg",
            loose.join(", ")
        ),
    };
    verdict("waffle", pass, Some(loose.len() as f64), Some(0.0), "", message)
}

fn mold_verdicts(results: &Results, m: &Mold) -> [json::Verdict; 4] {
    let apart = (results.mold_mesh_volume_mm3 / m.volume_mm3 - 1.0).abs();
    let agree = apart <= VOLUME_SHARE;
    let volumes = match agree {
        true => "OpenCascade's exact mold and CGAL's swept triangles have the same volume".to_owned(),
        false => "OpenCascade's exact mold and CGAL's swept triangles differ in volume: look for undercuts"
            .to_owned(),
    };
    let bad: Vec<&str> = m.parts.iter().filter(|p| !p.valid).map(|p| p.name.as_str()).collect();
    let parts = match bad.is_empty() {
        true => format!("all {} parts are closed solids and fit the printer", m.parts.len()),
        false => format!("parts {} are not valid; see their faults in the report", bad.join(", ")),
    };
    let undercuts = m.pose.undercuts.len();
    let draft = match undercuts {
        0 => "the board comes off the mold along z".to_owned(),
        n => format!("{n} places of the mold undercut; fold less or give another pose"),
    };
    [
        verdict("mold parts", bad.is_empty(), Some(bad.len() as f64), Some(0.0), "", parts),
        verdict("mold volume", agree, Some(100.0 * apart), Some(100.0 * VOLUME_SHARE), "%", volumes),
        waffle_verdict(m),
        verdict("mold draft", undercuts == 0, Some(m.pose.least_draft_deg), Some(0.0), "°", draft),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// r = 30, R = 500 in space, fold angle 90°: the excess is 9.105 mm and the shared strain 0.91 %.
    #[test]
    fn the_hoop_estimate_is_that_of_the_rotational_crease() {
        let half = std::f64::consts::FRAC_PI_4;
        let strain = shared_hoop_strain(30.0, 2.0 * half, half.cos() / 500.0);
        assert!((strain - 9.105 / 500.0 / 2.0).abs() < 1e-6, "{strain}");
    }
}
