//! `report.html`: one page for the designer, with everything inside it; no scripts, nothing from elsewhere.

use super::json::{
    Analyse, Board, Cage, Crosscheck, Fold, Mesh, Mold, Report, Shell, SpringBack, Stability, State, Surface,
    SurfaceShape, Verdict,
};
use super::page::{Facts, STYLE, drawing, legend, picture, section, table, timed_table};
use super::picture::Legend;
use super::summary::finding;
use super::words::{area, count, figure, maybe, percent, percent_size, place, volume, with_unit, yes};
use crate::export::escape_xml;

/// A rendered view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// What it shows, and from where.
    pub title: String,
    /// The picture, PNG.
    pub png: Vec<u8>,
    /// What its colours mean.
    pub legend: Option<Legend>,
}

/// All pictures of the page; empty ones are left out. The SVGs are softfold's own, see [`super::plans`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pictures {
    /// The pattern as it was read.
    pub flat_pattern_svg: String,
    /// The pattern with its bands.
    pub soft_pattern_svg: String,
    /// The folded sheet and the board.
    pub views: Vec<Picture>,
    /// What the surface does: radii, curvature, strain, rulings.
    pub surface: Vec<Picture>,
    /// Its rulings over the flat pattern.
    pub rulings_svg: String,
    /// How the board stands.
    pub stability_svg: String,
    /// The mold's parts from above.
    pub parts_svg: String,
    /// The waffle's boards on their stock.
    pub boards_svg: String,
}

/// The page.
pub fn html(report: &Report, pictures: &Pictures) -> String {
    let title = escape_xml(&report.pattern.name);
    let body = [
        header(report),
        key_figures(report),
        verdicts(&report.verdicts),
        section("folded", "Folded", &gallery(&pictures.views)),
        surface(report, pictures),
        patterns(report, pictures),
        issues(report),
        figures(report),
        stability(report, pictures),
        mold(report, pictures),
        files(report),
        times(report),
    ]
    .concat();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\"><title>{title} – softfold</title>\n\
         <style>\n{STYLE}</style></head>\n<body><main>\n{body}\
         <footer>Made by softfold {}. Lengths in millimetres; area errors compare each triangle of the folded sheet \
         with the same triangle of the flat one.</footer>\n</main></body></html>\n",
        escape_xml(&report.version)
    )
}

fn header(report: &Report) -> String {
    let failed = report.verdicts.iter().filter(|v| !v.pass).count();
    let total = report.verdicts.len();
    let pill = match (failed, total) {
        (_, 0) => String::new(),
        (0, _) => format!("<span class=\"pill good\">All {} passed</span>", count(total, "check", "checks")),
        _ => {
            format!("<span class=\"pill bad\">{failed} of {} failed</span>", count(total, "check", "checks"))
        }
    };
    format!("<header><h1>{}</h1>{pill}</header>\n", escape_xml(&report.pattern.name))
}

fn key_figures(report: &Report) -> String {
    let mut key = vec![("Sheet", area(report.pattern.area_mm2))];
    key.extend(report.fold.as_ref().map(|f| {
        let larger =
            if f.area_error_max.abs() > f.area_error_min.abs() { f.area_error_max } else { f.area_error_min };
        ("Largest area error", percent(larger))
    }));
    key.extend(
        report.analyse.as_ref().map(|a| ("Tightest bend of the sheet", maybe(a.min_bend_radius_mm, "mm"))),
    );
    key.extend(report.board.as_ref().map(|b| ("Mass", with_unit(b.mass_kg, "kg"))));
    key.extend(report.stability.as_ref().map(|s| {
        (
            "Stands",
            if s.stable {
                format!("yes, tips at {}", with_unit(s.tipping_angle_deg, "°"))
            } else {
                yes(false)
            },
        )
    }));
    key.extend(report.mold.as_ref().map(|m| {
        (
            "Mold",
            format!(
                "{}, {}",
                count(m.parts.len(), "part", "parts"),
                count(m.boards.len(), "board", "boards")
            ),
        )
    }));
    let cells: String =
        key.iter().map(|(l, f)| format!("<div><dt>{l}</dt><dd>{}</dd></div>", escape_xml(f))).collect();
    format!("<dl class=\"key\">{cells}</dl>\n")
}

fn verdicts(all: &[Verdict]) -> String {
    let item = |v: &Verdict| {
        let (class, mark) = if v.pass { ("pass", "✓ passed") } else { ("fail", "✗ failed") };
        format!(
            "<li class=\"{class}\"><span class=\"mark\">{mark}</span><span class=\"name\">{}</span><span>{}</span><span class=\"say\">{}</span></li>\n",
            escape_xml(&v.name),
            escape_xml(&finding(v)),
            escape_xml(&v.message)
        )
    };
    // What failed comes first.
    let (good, bad): (Vec<_>, Vec<_>) = all.iter().partition(|v| v.pass);
    let items: String = bad.into_iter().chain(good).map(item).collect();
    let list = if items.is_empty() { items } else { format!("<ul class=\"verdicts\">\n{items}</ul>\n") };
    section("verdicts", "Checks", &list)
}

/// What the surface does, beside its rulings over the flat sheet.
fn surface(report: &Report, pictures: &Pictures) -> String {
    let Some(shape) = report.surface.as_ref().and_then(|s| s.shape.as_ref()) else { return String::new() };
    let plan = drawing(
        &pictures.rulings_svg,
        "Rulings over the flat sheet",
        "Lines along which the sheet is straight; the darker, the less it bends along them. None where it is plane or bends \
         both ways.",
    );
    let beside = format!("<div class=\"gallery two\">\n{plan}{}</div>\n", shape_facts(shape));
    section("surface", "Surface", &(gallery(&pictures.surface) + &beside))
}

fn shape_facts(s: &SurfaceShape) -> String {
    let with_place = |value: String, at: &[f64; 2]| format!("{value} at {}", place(at));
    Facts::default()
        .row("Smallest radius", with_place(maybe(s.min_radius_mm, "mm"), &s.min_radius_at))
        .row("Lower skin", with_place(maybe(s.lower_skin_radius_mm, "mm"), &s.lower_skin_radius_at))
        .row("Upper skin", with_place(maybe(s.upper_skin_radius_mm, "mm"), &s.upper_skin_radius_at))
        .row("Limit of the material", maybe(s.radius_limit_mm, "mm"))
        .row(
            "Gaussian curvature, largest",
            with_place(with_unit(1e6 * s.gaussian_curvature_per_mm2, "1/m²"), &s.gaussian_curvature_at),
        )
        .row("Strain, smallest", with_place(percent(s.principal_strain_min), &s.principal_strain_min_at))
        .row("Strain, largest", with_place(percent(s.principal_strain_max), &s.principal_strain_max_at))
        .row("Plane", percent_size(s.plane_share))
        .row("Bends one way", percent_size(s.developable_share))
        .row("Bends both ways", percent_size(s.doubly_bent_share))
        .row("Rulings", s.rulings.to_string())
        .row(
            "Their largest bow",
            format!(
                "{} flat, {} in space",
                percent_size(s.ruling_bow_flat),
                percent_size(s.ruling_bow_space)
            ),
        )
        .finish("Shape of the surface")
}

/// Pictures side by side, with their legends.
pub(super) fn gallery(all: &[Picture]) -> String {
    let one = |p: &Picture| picture(&p.png, &p.title, &p.legend.as_ref().map(legend).unwrap_or_default());
    let figures: String = all.iter().map(one).collect();
    if figures.is_empty() { figures } else { format!("<div class=\"gallery\">\n{figures}</div>\n") }
}

fn patterns(report: &Report, pictures: &Pictures) -> String {
    let drawings =
        drawing(&pictures.flat_pattern_svg, "The pattern as drawn", "Mountain folds red, valley folds blue.")
            + &drawing(
                &pictures.soft_pattern_svg,
                "Softened",
                "Each crease has become a band of fold lines.",
            );
    let rows: Vec<_> = report.pattern.creases.iter().map(crease_row).collect();
    let head =
        ["Crease", "Role", "Length", "Fold angle", "Radius", "Strips", "Strip width", "Band width", "Arc"];
    let mut content = if drawings.is_empty() {
        drawings
    } else {
        format!("<div class=\"gallery two\">\n{drawings}</div>\n")
    };
    if !rows.is_empty() {
        content += &scroll(&format!("<h3>Creases</h3>{}", table(&head, &rows)));
    }
    section("pattern", "Pattern", &content)
}

fn crease_row(c: &super::json::Crease) -> Vec<String> {
    let role = match c.role.as_str() {
        "M" => "mountain",
        "V" => "valley",
        "F" => "flat",
        "U" => "undecided",
        other => other,
    };
    let mm = |x: f64| with_unit(x, "mm");
    vec![
        c.name.clone(),
        role.to_owned(),
        mm(c.length_mm),
        with_unit(c.fold_angle_deg, "°"),
        mm(c.radius_mm),
        c.segments.to_string(),
        mm(c.chord_mm),
        mm(c.band_width_mm),
        mm(c.arc_mm),
    ]
}

fn issues(report: &Report) -> String {
    let row = |i: &super::json::Issue| {
        let line = i.line.map(|l| format!("line {l}")).unwrap_or_default();
        let at = i.position_mm.map(|p| place(&p)).unwrap_or_default();
        let element = i.element.clone().unwrap_or_default();
        let found = [line, element, at].into_iter().filter(|s| !s.is_empty()).collect::<Vec<_>>().join(", ");
        vec![i.severity.clone(), i.message.clone(), found, i.mend.clone()]
    };
    let rows: Vec<_> = report.pattern.issues.iter().map(row).collect();
    if rows.is_empty() {
        return String::new();
    }
    section(
        "issues",
        "Remarks about the drawing",
        &scroll(&table(&["", "What", "Where", "What to do"], &rows)),
    )
}

fn figures(report: &Report) -> String {
    let tables: Vec<String> = [
        report.mesh.as_ref().map(mesh_facts),
        report.mesh.as_ref().and_then(|m| m.crosscheck.as_ref()).map(crosscheck_facts),
        report.fold.as_ref().map(fold_facts),
        report.analyse.as_ref().map(analyse_facts),
        report.surface.as_ref().map(surface_facts),
        report.surface.as_ref().and_then(|s| s.cage.as_ref()).map(cage_facts),
        report.board.as_ref().map(board_facts),
    ]
    .into_iter()
    .flatten()
    .collect();
    let mut content = if tables.is_empty() {
        String::new()
    } else {
        format!("<div class=\"grid\">\n{}</div>\n", tables.concat())
    };
    let goal = |g: &super::json::Goal| {
        vec![g.name.clone(), g.kind.clone(), figure(g.energy), maybe(g.residual_mm, "mm")]
    };
    let goals: Vec<_> = report.fold.iter().flat_map(|f| &f.goals).map(goal).collect();
    if !goals.is_empty() {
        content += &scroll(&format!(
            "<h3>Goals of the folding</h3>{}",
            table(&["Goal", "Kind", "Energy", "Farthest off"], &goals)
        ));
    }
    if let Some(f) = report.fold.as_ref().filter(|f| !f.states.is_empty()) {
        content += &scroll(&states(f));
    }
    section("figures", "Figures", &content)
}

/// The states of folding, and what creases kept when they were let go.
fn states(f: &Fold) -> String {
    let state =
        |s: &State| vec![s.name.clone(), s.iterations.to_string(), figure(s.energy), yes(s.converged)];
    let rows: Vec<_> = f.states.iter().map(state).collect();
    let mut content =
        format!("<h3>States of folding</h3>{}", table(&["State", "Steps", "Energy", "At rest"], &rows));
    let kept = |s: &SpringBack| {
        let angles = [s.reached_deg, s.rest_deg, s.released_deg].map(|a| with_unit(a, "°"));
        [vec![s.crease.clone()], angles.to_vec()].concat()
    };
    if !f.spring_back.is_empty() {
        let head = ["Crease", "Held", "Keeps by itself", "Let go"];
        let rows: Vec<_> = f.spring_back.iter().map(kept).collect();
        content += &format!("<h3>What creases keep</h3>{}", table(&head, &rows));
    }
    content
}

fn mesh_facts(m: &Mesh) -> String {
    Facts::default()
        .row("Vertices", m.vertices.to_string())
        .row("Triangles", m.triangles.to_string())
        .row("Smallest angle", with_unit(m.min_angle_deg, "°"))
        .row("Median of smallest angles", with_unit(m.median_min_angle_deg, "°"))
        .row("Triangulated by", &m.backend)
        .finish("Mesh")
}

fn crosscheck_facts(c: &Crosscheck) -> String {
    Facts::default()
        .row("All lines kept", yes(c.constraints_held))
        .row("Areas differ by", figure(c.area_relative_difference))
        .row("Edges free to differ", c.cocircular_differences.to_string())
        .row("Other edges that differ", c.other_differences.to_string())
        .finish("Cross-check of the triangulation")
}

fn fold_facts(f: &Fold) -> String {
    Facts::default()
        .row("Solver", format!("{}, {}", f.solver, count(f.iterations as usize, "step", "steps")))
        .row("At rest", format!("{} ({})", yes(f.converged), f.stop))
        .row("Energy", figure(f.energy))
        .row("Gradient, relative", figure(f.relative_gradient))
        .row("Largest change of an edge", percent_size(f.max_edge_strain))
        .row(
            "Area error, smallest",
            format!("{} at {}", percent(f.area_error_min), place(&f.area_error_min_at)),
        )
        .row(
            "Area error, largest",
            format!("{} at {}", percent(f.area_error_max), place(&f.area_error_max_at)),
        )
        .row(
            "Hoop strain to be expected",
            f.hoop_estimate.map_or_else(|| "–".to_owned(), |h| format!("±{}", percent_size(h))),
        )
        .row("Largest error of a turn", with_unit(f.turn_error_max_deg, "°"))
        .row(
            "Passes through itself",
            if f.self_intersections == 0 {
                "nowhere".to_owned()
            } else {
                count(f.self_intersections, "place", "places")
            },
        )
        .finish("Folding")
}

fn analyse_facts(a: &Analyse) -> String {
    Facts::default()
        .row("Tightest bend of the sheet", maybe(a.min_bend_radius_mm, "mm"))
        .row("at", place(&a.min_bend_radius_at))
        .row("Strain of the outer fibre", percent_size(a.max_fibre_strain))
        .row(
            "Principal strain",
            format!("{} to {}", percent(a.principal_strain_min), percent(a.principal_strain_max)),
        )
        .row("Largest angle defect", with_unit(a.max_angle_defect_rad, "rad"))
        .row("Nearest to itself", a.self_distance_mm.map_or_else(|| "far".to_owned(), |d| with_unit(d, "mm")))
        .finish("Material")
}

fn surface_facts(s: &Surface) -> String {
    Facts::default()
        .row("Faces", s.faces.to_string())
        .row("Poles", format!("{} × {}", s.poles[0], s.poles[1]))
        .row("Spacing", with_unit(s.spacing_mm, "mm"))
        .row(
            "Farthest from the folded sheet",
            format!("{} at {}", with_unit(s.max_deviation_mm, "mm"), place(&s.max_deviation_at)),
        )
        .row("Distance, root mean square", with_unit(s.rms_deviation_mm, "mm"))
        .row("Valid for CAD", yes(s.valid))
        .rows(s.shell.as_ref().map_or_else(Vec::new, shell_rows))
        .finish("NURBS surface")
}

fn shell_rows(s: &Shell) -> Vec<(&'static str, String)> {
    let edges = format!("{} sharp, {} smooth, {} lips of slits", s.creases, s.smooth_edges, s.slit_lips);
    let mut rows = vec![
        ("Edges between faces", edges),
        ("Faces part by at most", format!("{:.1e} mm at {}", s.gap_mm, place(&s.gap_at))),
        ("Tolerance of the edges", format!("{:.1e} mm", s.edge_tolerance_mm)),
    ];
    if !s.rounded.is_empty() {
        rows.push(("Rounded", s.rounded.join(", ")));
    }
    rows
}

fn cage_facts(c: &Cage) -> String {
    let degrees = |d: Option<f64>| d.map_or_else(|| "none".to_owned(), |d| with_unit(d, "°"));
    let irregular: Vec<String> =
        c.irregular.iter().map(|i| format!("{} at {}", i.valence, place(&i.at))).collect();
    let excused: Vec<String> =
        c.excused.iter().map(|e| format!("{} at {}", with_unit(e.angle_deg, "°"), place(&e.at))).collect();
    let listed = |l: Vec<String>| if l.is_empty() { "none".to_owned() } else { l.join("; ") };
    Facts::default()
        .row("Quads", c.quads.to_string())
        .row("Inner vertices of valence 4", percent_size(c.valence_4_share))
        .row("Other valences", listed(irregular))
        .row(
            "Smallest angle in the flat",
            format!("{} at {}", with_unit(c.min_angle_deg, "°"), place(&c.min_angle_at)),
        )
        .row("Sharper because the outline is", listed(excused))
        .row("Rows along the bands", c.rows_along_bands.map_or_else(|| "no bands".to_owned(), percent_size))
        .row("Cells", format!("{}, {} across a strip", with_unit(c.cell_mm, "mm"), c.cells_per_strip))
        .row("Border of the limit from the outline", with_unit(c.border_mm, "mm"))
        .row("Patches, and faces after merging", format!("{}, {}", c.patches, c.faces))
        .row("Faces apart where they meet", with_unit(c.gap_mm, "mm"))
        .row("Angle between faces, regular", degrees(c.g1_regular_deg))
        .row("Around irregular vertices", degrees(c.g1_irregular_deg))
        .row("Edges of more than 0.1°", c.rough.len().to_string())
        .finish("Conforming cage")
}

fn board_facts(b: &Board) -> String {
    Facts::default()
        .row("Thickness", with_unit(b.thickness_mm, "mm"))
        .row("Volume", volume(b.volume_mm3))
        .row("Area × thickness", volume(b.area_times_thickness_mm3))
        .row("Area and curvature × thickness", volume(b.offset_volume_mm3))
        .row("As triangles", volume(b.mesh_volume_mm3))
        .row("Cut off at the ground", b.trimmed_mm3.map_or_else(|| "–".to_owned(), volume))
        .row("Area", area(b.area_mm2))
        .row("Mass", with_unit(b.mass_kg, "kg"))
        .row("Barycenter as folded", place(&b.barycenter_mm))
        .row("Inertia xx, yy, zz", moments([0, 1, 2].map(|k| b.inertia_kg_mm2[k][k])))
        .row("Inertia xy, xz, yz", moments([(0, 1), (0, 2), (1, 2)].map(|(i, k)| b.inertia_kg_mm2[i][k])))
        .row("Principal moments", moments(b.principal_moments_kg_mm2))
        .row("Their axes", b.principal_axes.map(|a| direction(&a)).join(" "))
        .row("Smallest radius of a skin", maybe(b.min_radius_mm, "mm"))
        .row("Error of the thickness", with_unit(b.offset_error_mm, "mm"))
        .row("Valid solid", yes(b.valid))
        .finish("Board")
}

fn moments(values: [f64; 3]) -> String {
    values.map(figure).join(", ") + " kg·mm²"
}

fn direction(axis: &[f64; 3]) -> String {
    format!("({})", axis.map(|c| format!("{c:.3}")).join(", "))
}

fn stability(report: &Report, pictures: &Pictures) -> String {
    let plan = drawing(
        &pictures.stability_svg,
        "From above",
        "Green: the area between the contact points. Dashed: the way to its nearest edge.",
    );
    let facts = report.stability.as_ref().map(stability_facts).unwrap_or_default();
    let content = plan + &facts;
    let content =
        if content.is_empty() { content } else { format!("<div class=\"gallery two\">\n{content}</div>\n") };
    section("stability", "How it stands", &content)
}

fn stability_facts(s: &Stability) -> String {
    Facts::default()
        .row("Stands", yes(s.stable))
        .row("Barycenter to the nearest edge", with_unit(s.margin_mm, "mm"))
        .row("Tips at", with_unit(s.tipping_angle_deg, "°"))
        .row("Tips by a push at its top of", with_unit(s.tipping_push_n, "N"))
        .row("Tilts until it rests", with_unit(s.tilt_deg, "°"))
        .row("Barycenter at rest", place(&s.barycenter_mm))
        .row("Height", with_unit(s.height_mm, "mm"))
        .row("Contact points", s.contact_points.to_string())
        .finish("Stability")
}

fn mold(report: &Report, pictures: &Pictures) -> String {
    let drawings = drawing(
        &pictures.parts_svg,
        "Parts from above",
        "Blue: printed parts. Brown: boards of the waffle below them. Black: the sheet.",
    ) + &drawing(&pictures.boards_svg, "Boards on their stock", "As they are cut.");
    let mut content = if drawings.is_empty() {
        drawings
    } else {
        format!("<div class=\"gallery two\">\n{drawings}</div>\n")
    };
    if let Some(m) = &report.mold {
        content += &format!("<div class=\"grid\">\n{}</div>\n", mold_facts(m));
        content += &part_table(m);
        content += &board_table(m);
    }
    section("mold", "Mold", &content)
}

fn mold_facts(m: &Mold) -> String {
    Facts::default()
        .row("Volume", volume(m.volume_mm3))
        .row("Height", with_unit(m.height_mm, "mm"))
        .row("Least draft", with_unit(m.least_draft_deg, "°"))
        .row("Undercuts", m.undercuts.to_string())
        .row(
            "Printed parts",
            format!("{}, {} full cells", m.parts.len(), m.parts.iter().filter(|p| p.inner).count()),
        )
        .row("Boards", format!("{} on {}", m.boards.len(), count(m.sheets, "stock sheet", "stock sheets")))
        .row("Stock used", with_unit((100.0 * m.stock_use).round(), "%"))
        .finish("Mold")
}

fn part_table(m: &Mold) -> String {
    let row = |p: &super::json::Part| {
        let size = p.size_mm.map(|s| figure((s * 10.0).round() / 10.0)).join(" × ") + " mm";
        let state = if p.valid && p.faults.is_empty() { "good".to_owned() } else { p.faults.join("; ") };
        vec![
            p.name.clone(),
            size,
            volume(p.volume_mm3),
            if p.inner { "full cell" } else { "edge" }.to_owned(),
            state,
        ]
    };
    let rows: Vec<_> = m.parts.iter().map(row).collect();
    if rows.is_empty() {
        return String::new();
    }
    scroll(&format!("<h3>Printed parts</h3>{}", table(&["Part", "Size", "Volume", "Kind", "State"], &rows)))
}

fn board_table(m: &Mold) -> String {
    let row = |b: &super::json::WaffleBoard| {
        vec![b.name.clone(), with_unit(b.length_mm, "mm"), with_unit(b.height_mm, "mm")]
    };
    let rows: Vec<_> = m.boards.iter().map(row).collect();
    if rows.is_empty() {
        return String::new();
    }
    scroll(&format!("<h3>Boards</h3>{}", table(&["Board", "Length", "Height"], &rows)))
}

/// The many files of one kind in a folder as one: `parts/*.stl`.
fn grouped(path: &str) -> String {
    match (path.rsplit_once('/'), path.rsplit_once('.')) {
        (Some((folder, _)), Some((_, ending))) => format!("{folder}/*.{ending}"),
        _ => path.to_owned(),
    }
}

fn files(report: &Report) -> String {
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (pattern, purpose) in report.files.iter().map(|f| (grouped(&f.path), &f.purpose)) {
        if !rows.iter().any(|r| r[0] == pattern && r[1] == *purpose) {
            rows.push(vec![pattern, purpose.clone()]);
        }
    }
    let content =
        if rows.is_empty() { String::new() } else { scroll(&table(&["File", "What it is for"], &rows)) };
    section("files", "Files", &content)
}

fn times(report: &Report) -> String {
    let time = |s: f64| with_unit((s * 100.0).round() / 100.0, "s");
    let rows: Vec<_> = report.stages.iter().map(|s| vec![s.name.clone(), time(s.seconds)]).collect();
    let content =
        if rows.is_empty() { String::new() } else { scroll(&timed_table(&["Stage", "Time"], &rows)) };
    section("times", "Times", &content)
}

fn scroll(content: &str) -> String {
    format!("<div class=\"scroll\">{content}</div>\n")
}

#[cfg(test)]
mod tests {
    use super::super::json::{Pattern, tests::sample};
    use super::*;

    fn page() -> String {
        let pictures = Pictures {
            flat_pattern_svg: "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\"></svg>"
                .into(),
            views: vec![Picture { title: "from <front>".into(), png: vec![1, 2, 3], legend: None }],
            ..Pictures::default()
        };
        html(&sample(), &pictures)
    }

    #[test]
    fn asks_nothing_of_the_network_and_runs_nothing() {
        let text = page().replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
        for word in ["http", "<script", "url(", "<link", "@import", "<?xml"] {
            assert!(!text.contains(word), "{word}");
        }
    }

    #[test]
    fn user_text_is_escaped() {
        let text = page();
        assert!(text.contains("<h1>bench &lt;A&gt;</h1>") && text.contains("from &lt;front&gt;"));
        assert!(!text.contains("bench <A>"));
    }

    #[test]
    fn says_what_failed_first() {
        let text = page();
        assert!(text.contains("1 of 2 checks failed"));
        assert!(text.find("Mold parts").unwrap() < text.find("Bend radius").unwrap());
        assert!(text.contains("data:image/png;base64,AQID"));
    }

    #[test]
    fn sections_without_content_are_left_out() {
        let text = html(&Report::new(Pattern::default()), &Pictures::default());
        for id in ["verdicts", "folded", "pattern", "figures", "stability", "mold", "files", "times"] {
            assert!(!text.contains(&format!("id=\"{id}\"")), "{id}");
        }
    }
}
