//! The frames of a FOLD file: which one is read, and what it inherits.

use super::json::{self, kind, malformed, told};
use crate::PatternError;
use crate::error::issue;
use serde_json::{Map, Value};
use softfold_geometry::{Issue, Severity};

/// Longest chain of `frame_parent`; animations inherit from their key frame alone.
const MAX_DEPTH: usize = 100;
/// Frames that a note lists.
const SHOWN: usize = 8;

/// All frames, the key frame (the file's own object) first.
pub(super) struct Frames<'a> {
    own: Vec<&'a Map<String, Value>>,
    /// From which frame each inherits.
    parents: Vec<Option<usize>>,
}

/// One frame, with what it inherits.
#[derive(Clone, Copy)]
pub(super) struct Frame<'a> {
    frames: &'a Frames<'a>,
    index: usize,
}

impl<'a> Frames<'a> {
    /// The frames of a file.
    ///
    /// # Errors
    /// Frames that are no objects; parents that are none, or go round in a circle.
    pub(super) fn of(file: &'a Map<String, Value>) -> Result<Self, PatternError> {
        let mut own = vec![file];
        if let Some(frames) = file.get("file_frames") {
            for (i, frame) in json::list(frames, || "file_frames".to_owned())?.iter().enumerate() {
                let fault =
                    || malformed(&format!("file_frames[{i}]"), format!("it is {}, not a frame", kind(frame)));
                own.push(frame.as_object().ok_or_else(fault)?);
            }
        }
        let parents =
            own.iter().enumerate().map(|(i, f)| parent(f, i, own.len())).collect::<Result<_, _>>()?;
        let frames = Self { own, parents };
        (1..frames.own.len()).try_for_each(|i| frames.refuse_loop(i))?;
        Ok(frames)
    }

    fn refuse_loop(&self, frame: usize) -> Result<(), PatternError> {
        let mut at = frame;
        for _ in 0..MAX_DEPTH {
            match self.parents[at] {
                None => return Ok(()),
                Some(parent) => at = parent,
            }
        }
        let what = format!("frame {frame} inherits from itself, or through more than {MAX_DEPTH} frames");
        Err(malformed(&entry(frame, "frame_parent"), what))
    }

    fn frame(&'a self, index: usize) -> Frame<'a> {
        Frame { frames: self, index }
    }

    /// The frame to read: the wanted one, else the first crease pattern, else the first that can be used. A note
    /// lists the others.
    ///
    /// # Errors
    /// The wanted frame does not exist, or none can be used.
    pub(super) fn choose(
        &'a self,
        wanted: Option<usize>,
        issues: &mut Vec<Issue>,
    ) -> Result<Frame<'a>, PatternError> {
        let count = self.own.len();
        if let Some(w) = wanted.filter(|&w| w >= count) {
            let what = format!("frame {w} is wanted, but the file has {}", frames(count));
            let mend = format!("give a frame from 0 to {}", count - 1);
            return Err(PatternError::Malformed(told(Severity::Error, "file_frames", what, mend)));
        }
        let all = || (0..count).map(|i| self.frame(i));
        let usable = |f: &Frame<'_>| f.get("vertices_coords").is_some() && f.has_lines();
        let pattern = all().find(|f| usable(f) && f.is_class("creasePattern"));
        let chosen = match wanted {
            Some(w) => Some(self.frame(w)),
            None => pattern.or_else(|| all().find(usable)),
        };
        let chosen = chosen.filter(usable).ok_or_else(|| nothing(wanted))?;
        if count > 1 {
            let others: Vec<String> =
                all().filter(|f| f.index != chosen.index).map(|f| f.describe()).collect();
            let mut shown = others[..others.len().min(SHOWN)].join(", ");
            if others.len() > SHOWN {
                shown.push_str(&format!(" and {} more", others.len() - SHOWN));
            }
            let what = format!("{} is read; the others are {shown}", chosen.describe());
            issues.push(issue(Severity::Note, what, "give the frame's number to read another"));
        }
        Ok(chosen)
    }
}

impl<'a> Frames<'a> {
    /// The wanted frame, else the last whose class is `foldedForm`; none if there is no such frame. The last, because
    /// animations end where folding ends.
    pub(super) fn folded(&'a self, wanted: Option<usize>) -> Option<Frame<'a>> {
        let mut folded = (0..self.own.len()).filter(|&i| self.frame(i).is_class("foldedForm"));
        wanted.or_else(|| folded.next_back()).filter(|&i| i < self.own.len()).map(|i| self.frame(i))
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.own.len()
    }
}

fn frames(count: usize) -> String {
    if count == 1 { "frame 0 alone".to_owned() } else { format!("frames 0 to {}", count - 1) }
}

fn nothing(wanted: Option<usize>) -> PatternError {
    let has = "vertices_coords with edges_vertices or faces_vertices";
    let what = match wanted {
        Some(w) => format!("frame {w} lacks {has}"),
        None => format!("no frame of the file has {has}"),
    };
    let mend = "export the crease pattern with coordinates and edges";
    PatternError::Nothing(issue(Severity::Error, what, mend))
}

/// How an entry of a frame is named in messages.
fn entry(frame: usize, key: &str) -> String {
    if frame == 0 { key.to_owned() } else { format!("file_frames[{}].{key}", frame - 1) }
}

/// The frame that this one inherits from.
fn parent(frame: &Map<String, Value>, index: usize, count: usize) -> Result<Option<usize>, PatternError> {
    if index == 0 || frame.get("frame_inherit") != Some(&Value::Bool(true)) {
        return Ok(None);
    }
    let Some(parent) = frame.get("frame_parent") else { return Ok(None) };
    json::index(parent, count, "frame", || entry(index, "frame_parent")).map(Some)
}

impl<'a> Frame<'a> {
    /// A key's value, its own or inherited; `null` counts as absent.
    pub(super) fn get(&self, key: &str) -> Option<&'a Value> {
        let mut at = Some(self.index);
        while let Some(i) = at {
            if let Some(value) = self.frames.own[i].get(key) {
                return Some(value).filter(|v| !v.is_null());
            }
            at = self.frames.parents[i];
        }
        None
    }

    /// A list of the frame.
    ///
    /// # Errors
    /// The value is no list.
    pub(super) fn list(&self, key: &str) -> Result<Option<&'a [Value]>, PatternError> {
        self.get(key).map(|v| json::list(v, || self.entry(key))).transpose()
    }

    /// A text of the frame.
    pub(super) fn text(&self, key: &str) -> Option<&'a str> {
        self.get(key).and_then(Value::as_str)
    }

    /// How one of its entries is named in messages.
    pub(super) fn entry(&self, key: &str) -> String {
        // An inherited entry stands where its frame stands.
        let mut at = self.index;
        while !self.frames.own[at].contains_key(key) {
            match self.frames.parents[at] {
                Some(parent) => at = parent,
                None => return entry(self.index, key),
            }
        }
        entry(at, key)
    }

    /// How the `i`-th value of one of its lists is named in messages.
    pub(super) fn item(&self, key: &str, i: usize) -> String {
        format!("{}[{i}]", self.entry(key))
    }

    /// Whether `frame_classes` names this class.
    pub(super) fn is_class(&self, class: &str) -> bool {
        let classes = self.get("frame_classes").and_then(Value::as_array);
        classes.is_some_and(|c| c.iter().any(|v| v.as_str() == Some(class)))
    }

    /// Whether edges can be found.
    fn has_lines(&self) -> bool {
        ["edges_vertices", "faces_vertices"].iter().any(|key| self.get(key).is_some())
    }

    /// The keys of the frame itself.
    pub(super) fn own_keys(&self) -> impl Iterator<Item = &'a str> {
        self.frames.own[self.index].keys().map(String::as_str)
    }

    fn describe(&self) -> String {
        let title = self.text("frame_title").map(|t| format!(" '{}'", crate::lines::short(t)));
        let classes = self.get("frame_classes").and_then(Value::as_array);
        let class = classes.and_then(|c| c.first()).and_then(Value::as_str);
        let class = class.map(|c| format!(" ({})", crate::lines::short(c)));
        format!("frame {}{}{}", self.index, title.unwrap_or_default(), class.unwrap_or_default())
    }
}
