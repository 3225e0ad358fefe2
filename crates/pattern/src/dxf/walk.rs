//! From entities to strokes: blocks unfolded, roles found, everything laid onto the sheet.

use super::aci;
use super::blocks::Copies;
use super::content::{Block, Content, Entity, Layer};
use super::curve::{Chain, MAX_PIECES, Placement};
use super::entities::{self, Drawn, Remark};
use super::remarks::{Cause, Remarks};
use crate::drawing::Stroke;
use crate::error::{Origin, Place, issue};
use crate::roles::{RoleMap, role_of_layer};
use crate::{PatternError, colour};
use softfold_geometry::{Issue, Role, Segment, Severity};

/// Blocks within blocks.
const MAX_DEPTH: usize = 16;
/// What each of them adds to the work for one element, in groups: longer labels.
const DEPTH_GROUPS: usize = 8;
/// Groups that are read at most, those of a line twice, of a block once for each copy; a file of 50 MB has five million.
const MAX_GROUPS: usize = 20_000_000;
/// Heights below this share of the coordinates are rounding.
const FLAT: f64 = 1e-9;
/// Colour numbers that refer to the block or to the layer.
const BY_BLOCK: i64 = 0;
const BY_LAYER: i64 = 256;
/// The layer whose things take on the layer of the INSERT that draws them.
const FLOATING_LAYER: &str = "0";

/// Where a block's content is drawn: its INSERT, and those around it.
#[derive(Clone, Debug)]
struct Inside {
    place: Placement,
    /// Layers of the INSERTs, innermost first.
    layers: Vec<String>,
    /// Colour of the INSERT.
    rgb: Option<[u8; 3]>,
    /// What is added to labels: the INSERTs, innermost first.
    label: String,
    /// Handles of the INSERTs, outermost first.
    handles: Vec<Option<String>>,
    /// Their blocks.
    blocks: Vec<String>,
}

/// Layer and colour of an entity as it is drawn.
struct Look {
    layer: String,
    rgb: Option<[u8; 3]>,
    number: i64,
}

/// Makes strokes of a drawing.
pub(super) struct Walk<'a> {
    content: &'a Content<'a>,
    roles: &'a RoleMap,
    unit_mm: f64,
    strokes: Vec<Stroke>,
    remarks: Remarks,
    groups: usize,
    segments: usize,
}

impl<'a> Walk<'a> {
    pub(super) fn new(content: &'a Content<'a>, roles: &'a RoleMap, unit_mm: f64) -> Self {
        let (strokes, remarks) = (Vec::new(), Remarks::default());
        Self { content, roles, unit_mm, strokes, remarks, groups: 0, segments: 0 }
    }

    /// All strokes of the model, in the order of the file; what was left out is told.
    ///
    /// # Errors
    /// Numbers that are none, blocks that hold themselves, more than can be meant.
    pub(super) fn strokes(mut self, issues: &mut Vec<Issue>) -> Result<Vec<Stroke>, PatternError> {
        let outside = Inside {
            place: Placement::IDENTITY,
            layers: Vec::new(),
            rgb: aci::rgb(BY_BLOCK),
            label: String::new(),
            handles: Vec::new(),
            blocks: Vec::new(),
        };
        let walked = self.entities(&self.content.entities, &outside);
        self.remarks.tell(issues);
        walked.map(|()| self.strokes)
    }

    fn entities(&mut self, entities: &'a [Entity<'a>], inside: &Inside) -> Result<(), PatternError> {
        entities.iter().try_for_each(|entity| self.entity(entity, inside))
    }

    fn entity(&mut self, entity: &'a Entity<'a>, inside: &Inside) -> Result<(), PatternError> {
        self.count(entity, inside)?;
        let fields = entity.fields();
        let look = self.look(entity, inside)?;
        let is_insert = entity.kind == "INSERT";
        let cause = if fields.integer_or(67, 0)? != 0 {
            Some(Cause::Paper)
        } else if fields.integer_or(60, 0)? != 0 {
            Some(Cause::Invisible)
        } else if let Some(why) = self.hidden(&look.layer, is_insert) {
            Some(Cause::Hidden { layer: look.layer.clone(), why })
        } else {
            entity.foreign_kind().map(Cause::Kind)
        };
        match cause {
            Some(cause) => {
                self.remarks.add(cause, || origin(entity, inside));
                Ok(())
            }
            None if is_insert => self.insert(entity, &look, inside),
            None => self.line(entity, &look, inside),
        }
    }

    /// The work done so far is kept within bounds: small files can unfold to endless drawings.
    fn count(&mut self, entity: &Entity<'_>, inside: &Inside) -> Result<(), PatternError> {
        let vertices: usize = entity.vertices.iter().map(|v| v.len()).sum();
        self.groups += 1 + entity.tags.len() + vertices + DEPTH_GROUPS * inside.blocks.len();
        if self.groups <= MAX_GROUPS && self.segments <= MAX_PIECES {
            return Ok(());
        }
        let what = format!(
            "with all blocks unfolded the drawing has more than {MAX_PIECES} lines and curves, or {MAX_GROUPS} groups"
        );
        let found = issue(Severity::Error, what, "keep only the lines of the pattern").of(&entity.origin);
        Err(PatternError::Malformed(found))
    }

    fn look(&self, entity: &Entity<'_>, inside: &Inside) -> Result<Look, PatternError> {
        let fields = entity.fields();
        let own = fields.tag(8).map(|t| self.content.header.text.of(t)).filter(|name| !name.is_empty());
        let own = own.unwrap_or_else(|| FLOATING_LAYER.to_owned());
        let layer = match inside.layers.first() {
            Some(around) if own == FLOATING_LAYER => around.clone(),
            _ => own,
        };
        let number = fields.integer_or(62, BY_LAYER)?;
        let true_colour = fields.integer_or(420, -1)?;
        let rgb = match number {
            _ if true_colour >= 0 => Some(aci::rgb_of_true_colour(true_colour)),
            BY_BLOCK => inside.rgb,
            // A layer that is not declared is black.
            BY_LAYER => self.layer(&layer).map_or_else(|| aci::rgb(BY_BLOCK), |l| l.rgb),
            number => aci::rgb(number.saturating_abs()),
        };
        Ok(Look { layer, rgb, number })
    }

    fn layer(&self, name: &str) -> Option<&'a Layer> {
        self.content.layers.get(&name.to_lowercase())
    }

    /// Why an entity of this layer is not seen. A block whose INSERT is on a layer that is off is seen where its
    /// lines are on other layers.
    fn hidden(&self, layer: &str, is_insert: bool) -> Option<&'static str> {
        self.layer(layer).and_then(|l| l.hidden).filter(|why| !is_insert || *why != "is off")
    }

    fn insert(&mut self, entity: &'a Entity<'a>, look: &Look, inside: &Inside) -> Result<(), PatternError> {
        let text = self.content.header.text;
        let name = entity.fields().tag(2).map(|t| text.of(t)).unwrap_or_default();
        let key = name.to_lowercase();
        let Some(block) = self.content.blocks.get(&key).filter(|b| !b.external) else {
            let external = self.content.blocks.contains_key(&key);
            let why = if external { "is another file" } else { "is not in the file" };
            self.remarks.add(Cause::NoBlock { block: name, why }, || origin(entity, inside));
            return Ok(());
        };
        if inside.blocks.contains(&key) || inside.blocks.len() >= MAX_DEPTH {
            let what = match inside.blocks.contains(&key) {
                true => format!("the block \"{name}\" holds itself"),
                false => format!("blocks are nested more than {MAX_DEPTH} deep"),
            };
            let found = issue(Severity::Error, what, "explode the blocks and save again");
            return Err(PatternError::Malformed(found.of(&entity.origin)));
        }
        self.copies(entity, look, inside, (key, block))
    }

    fn copies(
        &mut self,
        entity: &'a Entity<'a>,
        look: &Look,
        inside: &Inside,
        (key, block): (String, &'a Block<'a>),
    ) -> Result<(), PatternError> {
        let copies = Copies::read(entity, block)?;
        let mut within = inside.clone();
        within.layers.insert(0, look.layer.clone());
        within.rgb = look.rgb;
        within.blocks.push(key);
        within.handles.push(None);
        for (number, place) in (1_usize..).zip(copies.places()) {
            let nth = if copies.many() { format!("[{number}]") } else { String::new() };
            within.place = inside.place.after(&place);
            within.label = format!(" in {}{nth}{}", entity.origin.label, inside.label);
            within.handles.pop();
            within.handles.push(entity.origin.id.as_ref().map(|id| format!("{id}{nth}")));
            self.count(entity, inside)?;
            self.entities(&block.entities, &within)?;
        }
        Ok(())
    }

    fn line(&mut self, entity: &Entity<'_>, look: &Look, inside: &Inside) -> Result<(), PatternError> {
        let origin = origin(entity, inside);
        let Some(role) = self.role(&origin, entity.origin.id.as_deref(), look, inside) else { return Ok(()) };
        let Drawn { chains, remark } = entities::drawn(entity)?;
        if let Some(remark) = remark {
            self.remarks.add(Cause::Curve(remark), || origin.clone());
        }
        let chains: Vec<Chain> =
            chains.iter().map(|c| c.iter().map(|p| p.mapped(|q| inside.place.of(q))).collect()).collect();
        if let Some(cause) = off_plane(&chains) {
            self.remarks.add(cause, || origin.clone());
        }
        let pieces = self.pieces(&chains, entity)?;
        if pieces.is_empty() {
            if remark != Some(Remark::NoSize) {
                self.remarks.add(Cause::NoLength, || origin);
            }
            return Ok(());
        }
        self.segments += pieces.iter().map(Vec::len).sum::<usize>();
        self.strokes.push(Stroke { role, fold_angle_rad: None, origin, pieces });
        self.count(entity, inside)
    }

    /// The role of a line; what has none is told, unless the user left it out.
    fn role(&mut self, origin: &Origin, handle: Option<&str>, look: &Look, inside: &Inside) -> Option<Role> {
        let layers: Vec<&str> =
            std::iter::once(&look.layer).chain(&inside.layers).map(String::as_str).collect();
        let own = [origin.id.as_deref(), Some(origin.label.as_str()), handle];
        let around = inside.handles.iter().rev().map(Option::as_deref);
        let named = own.into_iter().chain(around).flatten().find(|id| self.roles.elements.contains_key(*id));
        if let Some(role) = self.roles.of(named, &layers, look.rgb) {
            return role;
        }
        let by_layer = layers.iter().find_map(|name| role_of_layer(name));
        let role = by_layer.or_else(|| look.rgb.and_then(colour::role_of));
        if role.is_none() {
            let colour = match look.rgb {
                Some([r, g, b]) => format!("#{r:02x}{g:02x}{b:02x}"),
                None => format!("number {}", look.number),
            };
            self.remarks.add(Cause::NoRole { layer: look.layer.clone(), colour }, || origin.clone());
        }
        role
    }

    /// Chains on the sheet, without what has no length there.
    fn pieces(&self, chains: &[Chain], entity: &Entity<'_>) -> Result<Vec<Vec<Segment>>, PatternError> {
        let length = |s: &Segment| s.control_points().iter().any(|p| *p != s.from());
        let of = |c: &Chain| c.iter().map(|p| p.on_sheet(self.unit_mm)).filter(length).collect();
        let pieces: Vec<Vec<Segment>> = chains.iter().map(of).filter(|c: &Vec<_>| !c.is_empty()).collect();
        let finite = |s: &Segment| s.control_points().iter().all(|p| p.is_finite());
        match pieces.iter().flatten().all(finite) {
            true => Ok(pieces),
            false => Err(entity.fields().fault("a coordinate is too large".to_owned(), None)),
        }
    }
}

/// The origin of an entity as it is drawn: with the blocks that it lies in.
fn origin(entity: &Entity<'_>, inside: &Inside) -> Origin {
    let label = format!("{}{}", entity.origin.label, inside.label);
    let handles = inside.handles.iter().map(Option::as_deref).chain([entity.origin.id.as_deref()]);
    let id = handles.collect::<Option<Vec<&str>>>().map(|all| all.join("/"));
    Origin { label, id, line: entity.origin.line }
}

/// Whether curves lie off the plane of the sheet.
fn off_plane(chains: &[Chain]) -> Option<Cause> {
    let points = || chains.iter().flatten().flat_map(|p| p.points());
    let reach = FLAT * points().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let [low, high] = points().fold([f64::MAX, f64::MIN], |[l, h], p| [l.min(p.z), h.max(p.z)]);
    match () {
        () if low > high || low.abs().max(high.abs()) <= reach => None,
        () if high - low > reach => Some(Cause::Tilted),
        () => Some(Cause::Height),
    }
}
