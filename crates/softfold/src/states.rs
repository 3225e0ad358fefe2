//! The states of folding in their order: a schedule's, each from where the one before came to rest, and the release.

use crate::goals::goals;
use crate::project::{line_of_entry, line_of_header};
use crate::{Loaded, RunError, pyramid};
use softfold_fold::{FoldError, Goal, Iteration, Part, Scales, Solver, address, schedule};
use softfold_geometry::{CreaseId, CreasePattern, DVec3, FlatMesh, FoldedSheet};
use std::collections::BTreeMap;

/// A state at rest.
pub struct State {
    /// Its name.
    pub name: String,
    /// Its sheet; the mesh has the turns of this state.
    pub sheet: FoldedSheet,
}

/// What a crease kept when it was let go; fold angles in rad, + valley.
#[derive(Clone, Debug, PartialEq)]
pub struct SpringBack {
    /// Its name.
    pub crease: String,
    /// Reached before.
    pub reached_rad: f64,
    /// At which it is at rest by itself afterwards.
    pub rest_rad: f64,
    /// Reached afterwards.
    pub released_rad: f64,
}

/// All states; the last is the result.
pub(crate) struct Course {
    pub(crate) states: Vec<State>,
    pub(crate) spring_back: Vec<SpringBack>,
    /// What acts on the last state.
    pub(crate) goals: Vec<Box<dyn Goal>>,
}

/// What folding starts from.
pub(crate) struct Beginning<'a> {
    pub(crate) mesh: &'a FlatMesh,
    pub(crate) pattern: &'a CreasePattern,
    pub(crate) start: Vec<DVec3>,
    pub(crate) solver: Solver,
}

/// Name of the only state where no schedule is given, and of the one after the release.
const FOLDED: &str = "folded";
const RELEASED: &str = "released";
/// Name of the load that the sheet cannot be released from.
const SELF_WEIGHT: &str = "self weight";

/// Folds through all states; `watch` is told the state's name with each iteration.
///
/// # Errors
/// Creases and holds that there are not, goals off the sheet, a solver that gives up.
pub(crate) fn fold_all(
    loaded: &Loaded,
    beginning: Beginning<'_>,
    watch: &mut dyn FnMut(&str, Iteration<'_>),
) -> Result<Course, RunError> {
    check_names(loaded, beginning.pattern)?;
    let Beginning { mesh, pattern, start, solver } = beginning;
    let name_of = |c: CreaseId| pattern.creases.get(c.index()).map_or("", |c| c.name.as_str());
    let mut run = Run { loaded, pattern, watch, x: start, solver, states: Vec::new() };
    let steps = &loaded.project.fold.schedule;
    let mut acting = goals(loaded, mesh, pattern)?;
    if steps.is_empty() {
        run.fold(FOLDED, mesh, &acting, &|_| 1.0)?;
    }
    for step in steps {
        let share = |c| step.share(name_of(c));
        let mesh = schedule::with_share(mesh, share);
        acting = goals(loaded, &mesh, pattern)?;
        run.fold(&step.title(), &mesh, &acting, &share)?;
    }
    let mut spring_back = Vec::new();
    if let (Some(release), Some(reached)) = (&loaded.project.fold.release, run.states.last()) {
        let before = schedule::fold_angles_rad(&reached.sheet);
        let mesh = schedule::after_release(&reached.sheet, |c| release.share(name_of(c)));
        acting = goals(loaded, &mesh, pattern)?;
        acting.retain(|g| stays(g.as_ref(), &release.keep));
        run.fold(RELEASED, &mesh, &acting, &|_| 1.0)?;
        let after = run.states.last().map(|s| schedule::fold_angles_rad(&s.sheet)).unwrap_or_default();
        spring_back = before
            .into_iter()
            .map(|(crease, reached_rad)| SpringBack {
                crease: name_of(crease).to_owned(),
                reached_rad,
                rest_rad: release.share(name_of(crease)) * reached_rad,
                released_rad: after.get(&crease).copied().unwrap_or_default(),
            })
            .collect();
    }
    Ok(Course { states: run.states, spring_back, goals: acting })
}

/// Whether a goal stays when the holds are let go.
fn stays(goal: &dyn Goal, keep: &[String]) -> bool {
    goal.part() != Part::Hold || goal.name() == SELF_WEIGHT || keep.iter().any(|name| name == goal.name())
}

struct Run<'a> {
    loaded: &'a Loaded,
    pattern: &'a CreasePattern,
    watch: &'a mut dyn FnMut(&str, Iteration<'_>),
    /// Where the last state came to rest.
    x: Vec<DVec3>,
    solver: Solver,
    states: Vec<State>,
}

impl Run<'_> {
    /// The first state goes through a pyramid of coarser meshes, whose creases fold by `share` too; later ones begin
    /// where the last came to rest.
    fn fold(
        &mut self,
        name: &str,
        mesh: &FlatMesh,
        goals: &[Box<dyn Goal>],
        share: &dyn Fn(CreaseId) -> f64,
    ) -> Result<(), RunError> {
        let warm = !self.states.is_empty();
        let solver = if warm { without_ramp(&self.solver) } else { self.solver.clone() };
        let mut watch = |i: Iteration<'_>| (self.watch)(name, i);
        let sheet = match solver {
            Solver::Newton(options) if !warm => {
                let meshes = pyramid::Meshes::new(self.loaded, self.pattern, mesh, share);
                let between = |k: usize| meshes.between(k);
                let pyramid = meshes.pyramid(&between);
                softfold_fold::fold_multilevel(&pyramid, mesh, goals, &self.x, &options, &mut watch)
            }
            solver => softfold_fold::fold(mesh, goals, &self.x, &solver, &mut watch),
        }
        .map_err(|e: FoldError| self.loaded.fault("fold", "solver", e))?;
        sheet.check().map_err(|e| RunError::Defect(e.to_string()))?;
        self.x.clone_from(&sheet.positions);
        self.states.push(State { name: name.to_owned(), sheet });
        Ok(())
    }
}

/// The solver without its softened start: a sheet that is folded already must not be let go again.
fn without_ramp(solver: &Solver) -> Solver {
    let mut solver = solver.clone();
    match &mut solver {
        Solver::Newton(options) => options.ramp = vec![Scales::FULL],
        Solver::Lbfgs(options) => options.ramp = vec![Scales::FULL],
        Solver::Relax(_) => (),
    }
    solver
}

/// Creases and holds that the schedule and the release name must be there.
fn check_names(loaded: &Loaded, pattern: &CreasePattern) -> Result<(), RunError> {
    let fold = &loaded.project.fold;
    let unknown = |creases: &BTreeMap<String, f64>| {
        creases.keys().find(|name| pattern.creases.iter().all(|c| c.name != **name)).cloned()
    };
    let none = |name: &str| {
        format!("the pattern has no crease '{name}'; it has {}", address::listed(&pattern.creases))
    };
    for (i, step) in fold.schedule.iter().enumerate() {
        if let Some(name) = unknown(&step.creases) {
            let line = line_of_entry(&loaded.text, "fold.schedule", i);
            let message = format!("[[fold.schedule]] '{}': {}", step.title(), none(&name));
            return Err(RunError::in_file(&loaded.path, line, message));
        }
    }
    let Some(release) = &fold.release else { return Ok(()) };
    let line = line_of_header(&loaded.text, "fold.release");
    let fault =
        |message: String| Err(RunError::in_file(&loaded.path, line, format!("[fold.release]: {message}")));
    if let Some(name) = unknown(&release.creases) {
        return fault(none(&name));
    }
    let holds = fold.hold_names();
    match release.keep.iter().find(|name| !holds.contains(&name.as_str())) {
        Some(name) => {
            fault(format!("keep names '{name}', but no hold has this name; there are {}", holds.join(", ")))
        }
        None => Ok(()),
    }
}
