//! The order of work: profiles, ends, cuts, bands, regions, contacts; and the largest radius that fits.

use crate::boundary::Boundary;
use crate::contact::{Contact, Crowd, Owner, Region};
use crate::junction::{self, NoRoom};
use crate::layout::{EndKind, Layout};
use crate::profile::Profile;
use crate::shape::{Ends, Problem, Shape, Sheet};
use crate::{CreaseSoftness, Fault, Misfit, SoftenError};
use softfold_geometry::{Band, CreaseEnd, CreasePattern, DVec2, JunctionRegion, Role, SoftPattern};
use std::collections::{BTreeMap, BTreeSet};

/// Halvings of the search for the largest radius: to 1e-9 of the refused one.
const RADIUS_HALVINGS: u32 = 30;
/// Halvings of the search for a factor on all radii: to 1e-4 of those asked for.
const ALL_HALVINGS: u32 = 14;
/// The largest radius that is named is smaller than the largest found by this share: it survives being
/// written with a few digits less.
const NAMED_SHARE: f64 = 1e-9;

/// The profile of each crease that is tried.
type Profiles<'f, 'p> = &'f dyn Fn(usize) -> Option<&'p Profile>;

/// Everything that stays the same while radii are tried.
pub(crate) struct Stage<'a> {
    pattern: &'a CreasePattern,
    softness: &'a [CreaseSoftness],
    sheet: Sheet,
    layout: Layout,
    /// By crease; none for flat creases.
    profiles: Vec<Option<Profile>>,
}

/// Bands and regions of some creases and meetings.
#[derive(Default)]
struct Built {
    cuts_mm: BTreeMap<CreaseEnd, f64>,
    shapes: BTreeMap<usize, Shape>,
    regions: BTreeMap<usize, Region>,
    /// By crease and, for regions, meeting: the first one is told.
    problems: Vec<(usize, Problem)>,
}

impl<'a> Stage<'a> {
    pub(crate) fn new(
        pattern: &'a CreasePattern,
        softness: &'a [CreaseSoftness],
    ) -> Result<Self, SoftenError> {
        let tolerance = pattern.tolerance();
        let boundary = Boundary::new(pattern, tolerance.chord_mm);
        let layout = Layout::new(pattern, &boundary, tolerance.join_mm);
        let profile = |(crease, softness): (&softfold_geometry::Crease, &CreaseSoftness)| {
            (crease.role != Role::Flat)
                .then(|| {
                    Profile::new(crease, softness, layout.is_ring(crease))
                        .map_err(|fault| SoftenError::of(crease, fault))
                })
                .transpose()
        };
        let profiles = pattern.creases.iter().zip(softness).map(profile).collect::<Result<_, _>>()?;
        Ok(Self { pattern, softness, sheet: Sheet { boundary, tolerance }, layout, profiles })
    }

    /// The softened pattern.
    ///
    /// # Errors
    /// The first band or region that does not fit.
    pub(crate) fn run(&self) -> Result<SoftPattern, SoftenError> {
        let all: Vec<usize> = (0..self.pattern.creases.len()).collect();
        let meetings: Vec<usize> = (0..self.layout.meetings.len()).collect();
        let profiles = |i: usize| self.profiles[i].as_ref();
        let built = self.build(&all, &meetings, &profiles, &Built::default());
        let first = built.problems.iter().min_by_key(|(i, _)| *i);
        if let Some((i, problem)) = first {
            return Err(self.refusal(*i, problem, &built));
        }
        if let Some(contact) = self.crowd(&built, |_| true).contact() {
            return Err(self.contact_refusal(&contact, &built));
        }
        Ok(self.soft_pattern(built))
    }

    /// Bands and regions; what is not among them is as in `base`.
    fn build<'p>(
        &'p self,
        creases: &[usize],
        meetings: &[usize],
        profiles: Profiles<'_, 'p>,
        base: &Built,
    ) -> Built {
        let mut built = Built::default();
        let mut failed = BTreeSet::new();
        for &j in meetings {
            let meeting = &self.layout.meetings[j];
            match junction::cuts(meeting, self.pattern, profiles) {
                Ok(cuts) => built.cuts_mm.extend(meeting.ends.iter().copied().zip(cuts)),
                Err(NoRoom { end }) => {
                    let problem = Problem::Misfit(Misfit::junction(), meeting.point);
                    built.problems.push((end.crease.index(), problem));
                    failed.insert(j);
                }
            }
        }
        for &i in creases {
            let kinds = self.layout.ends[i];
            let unknown = kinds.iter().any(|k| matches!(k, EndKind::Meeting(j) if failed.contains(j)));
            let Some(profile) = profiles(i).filter(|_| !unknown) else { continue };
            let crease = &self.pattern.creases[i];
            let cut = |side| {
                let end = CreaseEnd { crease: crease.id, side };
                built.cuts_mm.get(&end).or_else(|| base.cuts_mm.get(&end)).copied().unwrap_or(0.0)
            };
            let ends = Ends { kinds, cuts_mm: [cut(0), cut(1)] };
            match Shape::new(&self.sheet, crease, profile, &ends) {
                Ok(shape) => drop(built.shapes.insert(i, shape)),
                Err(problem) => built.problems.push((i, problem)),
            }
        }
        for &j in meetings {
            self.build_region(j, &mut built);
        }
        built
    }

    fn build_region(&self, j: usize, built: &mut Built) {
        let meeting = &self.layout.meetings[j];
        if meeting.ends.iter().any(|e| !built.shapes.contains_key(&e.crease.index())) {
            return;
        }
        let lines_at =
            |e: CreaseEnd| built.shapes.get(&e.crease.index()).map_or(Vec::new(), |s| s.lines_at(e.side, j));
        let polygon = junction::polygon(meeting, &lines_at);
        let region = Region { point: meeting.point, polygon, on_boundary: meeting.walls.is_some() };
        let slack_mm = 2.0 * self.sheet.tolerance.join_mm;
        if let Some(at) = region.meets_boundary(&self.sheet.boundary, slack_mm) {
            built.problems.push((self.softest_at(j), Problem::Misfit(Misfit::junction(), at)));
        }
        built.regions.insert(j, region);
    }

    fn crowd<'b>(&self, built: &'b Built, taken: impl Fn(Owner) -> bool) -> Crowd<'b> {
        let shapes = built.shapes.iter().filter(|(i, _)| taken(Owner::Band(**i))).map(|(i, s)| (*i, s));
        let regions = built.regions.iter().filter(|(j, _)| taken(Owner::Region(**j))).map(|(j, r)| (*j, r));
        Crowd::new(shapes.collect(), regions.collect(), self.sheet.tolerance.join_mm)
    }

    fn largest_radius_mm(&self, i: usize) -> f64 {
        self.profiles[i].as_ref().map_or(0.0, Profile::largest_radius_mm)
    }

    /// The crease with the largest radius at a meeting.
    fn softest_at(&self, j: usize) -> usize {
        let creases = self.layout.meetings[j].ends.iter().map(|e| e.crease.index());
        creases
            .reduce(|a, b| if self.largest_radius_mm(b) > self.largest_radius_mm(a) { b } else { a })
            .unwrap_or(0)
    }

    fn refusal(&self, i: usize, problem: &Problem, built: &Built) -> SoftenError {
        let fault = match problem {
            Problem::Fault(fault) => fault.clone(),
            Problem::Misfit(Misfit::Junction { .. }, at) => self.junction_misfit(i, *at, built),
            Problem::Misfit(why, at) => self.misfit(i, why.clone(), *at, built),
        };
        SoftenError::of(&self.pattern.creases[i], fault)
    }

    fn contact_refusal(&self, contact: &Contact, built: &Built) -> SoftenError {
        let at = contact.at;
        let (i, fault) = match contact.owners {
            [Owner::Band(i), Owner::Band(j)] if i == j => (i, self.misfit(i, Misfit::Itself, at, built)),
            [Owner::Band(i), Owner::Band(j)] => {
                // A sharp crease has no radius to mend.
                let radii = [i, j].map(|i| self.largest_radius_mm(i));
                let (i, j) = if radii[0] == 0.0 && radii[1] > 0.0 { (j, i) } else { (i, j) };
                let why = Misfit::Band {
                    other: self.pattern.creases[j].name.clone(),
                    other_largest_radius_mm: self.largest_fitting_mm(j, built),
                };
                (i, self.misfit(i, why, at, built))
            }
            [Owner::Band(_) | Owner::Region(_), Owner::Region(j)] => {
                let i = self.softest_at(j);
                (i, self.junction_misfit(i, at, built))
            }
            [Owner::Region(j), Owner::Band(_)] => {
                let i = self.softest_at(j);
                (i, self.junction_misfit(i, at, built))
            }
        };
        SoftenError::of(&self.pattern.creases[i], fault)
    }

    fn misfit(&self, i: usize, why: Misfit, at: DVec2, built: &Built) -> Fault {
        let (radius_mm, largest_radius_mm) = (self.largest_radius_mm(i), self.largest_fitting_mm(i, built));
        let all_share = if largest_radius_mm.is_none() { self.largest_share_of_all() } else { None };
        Fault::Misfit { why: Box::new(why), at, radius_mm, largest_radius_mm, all_share }
    }

    /// A misfit of a region: all creases that meet there have a part in it.
    fn junction_misfit(&self, i: usize, at: DVec2, built: &Built) -> Fault {
        let near = |j: &usize| self.layout.ends[i].contains(&EndKind::Meeting(*j));
        let distance = |j: &usize| self.layout.meetings[*j].point.distance_squared(at);
        let meetings = (0..self.layout.meetings.len()).filter(near);
        let Some(j) = meetings.min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
            return self.misfit(i, Misfit::junction(), at, built);
        };
        let creases: BTreeSet<usize> =
            self.layout.meetings[j].ends.iter().map(|e| e.crease.index()).collect();
        let name = |i: &usize| self.pattern.creases[*i].name.clone();
        let why = Misfit::Junction {
            creases: creases.iter().map(name).collect(),
            largest_share: self.largest_share(&creases, built),
        };
        self.misfit(i, why, at, built)
    }

    fn largest_fitting_mm(&self, i: usize, built: &Built) -> Option<f64> {
        let share = self.largest_share(&BTreeSet::from([i]), built)?;
        Some(share * self.largest_radius_mm(i))
    }

    /// The largest factor on the radii of some creases with which they fit between the other bands, by
    /// halving: a smaller band lies inside a larger one, so what fits is an interval from 0. None if
    /// they do not even fit sharp, or are sharp already.
    fn largest_share(&self, creases: &BTreeSet<usize>, built: &Built) -> Option<f64> {
        if creases.iter().all(|i| self.largest_radius_mm(*i) == 0.0) {
            return None;
        }
        let trial = Trial::new(self, creases, built);
        largest(RADIUS_HALVINGS, |factor| trial.fits(factor))
    }

    /// The largest factor on all radii with which all bands fit.
    fn largest_share_of_all(&self) -> Option<f64> {
        let all: BTreeSet<usize> = (0..self.pattern.creases.len()).collect();
        if all.iter().all(|i| self.largest_radius_mm(*i) == 0.0) {
            return None;
        }
        let nothing = Built::default();
        let trial = Trial::new(self, &all, &nothing);
        largest(ALL_HALVINGS, |factor| trial.fits(factor))
    }

    fn soft_pattern(&self, mut built: Built) -> SoftPattern {
        let flat = |i: usize| Band {
            crease: self.pattern.creases[i].id,
            segments: 0,
            profile: Vec::new(),
            fold_lines: Vec::new(),
        };
        let bands = (0..self.pattern.creases.len())
            .map(|i| built.shapes.remove(&i).map_or_else(|| flat(i), |s| s.band))
            .collect();
        let junction = |(j, region): (usize, Region)| JunctionRegion {
            point: region.point,
            polygon: region.polygon,
            creases: {
                let mut creases: Vec<_> = self.layout.meetings[j].ends.iter().map(|e| e.crease).collect();
                creases.sort();
                creases.dedup();
                creases
            },
        };
        SoftPattern {
            loops: self.pattern.loops().map(|(_, c)| c.clone()).collect(),
            slits: self.pattern.slits.clone(),
            bands,
            junctions: built.regions.into_iter().map(junction).collect(),
            tolerance: self.sheet.tolerance,
        }
    }
}

/// The largest factor below 1 that fits, by halving; none if 0 does not.
fn largest(halvings: u32, fits: impl Fn(f64) -> bool) -> Option<f64> {
    if !fits(0.0) {
        return None;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..halvings {
        let middle = 0.5 * (low + high);
        if fits(middle) { low = middle } else { high = middle }
    }
    Some(low * (1.0 - NAMED_SHARE))
}

/// Some creases whose radii are tried, with what they move and what they may not touch.
struct Trial<'a> {
    stage: &'a Stage<'a>,
    scaled: &'a BTreeSet<usize>,
    /// The scaled creases and all that meet them.
    creases: Vec<usize>,
    meetings: Vec<usize>,
    base: &'a Built,
    others: Crowd<'a>,
}

impl<'a> Trial<'a> {
    fn new(stage: &'a Stage<'a>, scaled: &'a BTreeSet<usize>, base: &'a Built) -> Self {
        let kinds = scaled.iter().flat_map(|i| stage.layout.ends[*i]);
        let meetings: BTreeSet<usize> =
            kinds.filter_map(|k| if let EndKind::Meeting(j) = k { Some(j) } else { None }).collect();
        let met = meetings.iter().flat_map(|j| &stage.layout.meetings[*j].ends).map(|e| e.crease.index());
        let creases: BTreeSet<usize> = scaled.iter().copied().chain(met).collect();
        let others = stage.crowd(base, |owner| match owner {
            Owner::Band(i) => !creases.contains(&i),
            Owner::Region(j) => !meetings.contains(&j),
        });
        let (creases, meetings) = (creases.into_iter().collect(), meetings.into_iter().collect());
        Self { stage, scaled, creases, meetings, base, others }
    }

    fn fits(&self, factor: f64) -> bool {
        let stage = self.stage;
        let scaled: Option<BTreeMap<usize, Profile>> = self
            .scaled
            .iter()
            .filter(|i| stage.profiles[**i].is_some())
            .map(|&i| {
                let softness = stage.softness[i].scaled(factor);
                let crease = &stage.pattern.creases[i];
                Profile::new(crease, &softness, stage.layout.is_ring(crease)).ok().map(|p| (i, p))
            })
            .collect();
        let Some(scaled) = scaled else { return false };
        let profiles = |i: usize| scaled.get(&i).or(stage.profiles[i].as_ref());
        let built = stage.build(&self.creases, &self.meetings, &profiles, self.base);
        if !built.problems.is_empty() {
            return false;
        }
        let crowd = stage.crowd(&built, |_| true);
        crowd.contact().is_none() && crowd.contact_with(&self.others, |_, _| true).is_none()
    }
}
