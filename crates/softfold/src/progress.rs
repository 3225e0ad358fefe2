//! What a run tells while it works: bars on a terminal, lines in a pipe, JSON for programs, or nothing.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Listens to a run.
pub trait Progress {
    /// A stage begins.
    fn begin(&mut self, stage: &str);
    /// A stage goes on: `done` of the whole, 0 to 1 where it is known, and a short word.
    fn advance(&mut self, done: Option<f64>, word: &str);
    /// A stage has ended.
    fn end(&mut self, stage: &str, seconds: f64, result: &str);
}

/// Says nothing.
pub struct Quiet;

impl Progress for Quiet {
    fn begin(&mut self, _: &str) {}
    fn advance(&mut self, _: Option<f64>, _: &str) {}
    fn end(&mut self, _: &str, _: f64, _: &str) {}
}

/// One line a stage, on the given sink.
pub struct Lines<W: std::io::Write>(pub W);

impl<W: std::io::Write> Progress for Lines<W> {
    fn begin(&mut self, _: &str) {}
    fn advance(&mut self, _: Option<f64>, _: &str) {}

    fn end(&mut self, stage: &str, seconds: f64, result: &str) {
        // A closed pipe must not end the run.
        let _ = writeln!(self.0, "{stage:<10} {seconds:6.1} s  {result}");
    }
}

/// One JSON object a line, on the given sink.
pub struct Events<W: std::io::Write>(pub W);

impl<W: std::io::Write> Events<W> {
    fn send(&mut self, event: &serde_json::Value) {
        let _ = writeln!(self.0, "{event}");
    }
}

impl<W: std::io::Write> Progress for Events<W> {
    fn begin(&mut self, stage: &str) {
        self.send(&serde_json::json!({ "event": "begin", "stage": stage }));
    }

    fn advance(&mut self, done: Option<f64>, word: &str) {
        self.send(&serde_json::json!({ "event": "advance", "done": done, "word": word }));
    }

    fn end(&mut self, stage: &str, seconds: f64, result: &str) {
        self.send(
            &serde_json::json!({ "event": "end", "stage": stage, "seconds": seconds, "result": result }),
        );
    }
}

/// A bar a stage.
#[derive(Default)]
pub struct Bars {
    bar: Option<ProgressBar>,
}

/// Steps of a bar.
const STEPS: u64 = 1000;
/// How often a bar without known end turns.
const TURN: Duration = Duration::from_millis(120);

impl Bars {
    /// A template of indicatif; its parts are fixed here, so it is always understood.
    fn style(template: &str) -> ProgressStyle {
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
    }
}

impl Progress for Bars {
    fn begin(&mut self, stage: &str) {
        let bar = ProgressBar::new(STEPS);
        bar.set_style(Self::style("{prefix:<10} {spinner} [{bar:28}] {elapsed} {msg}"));
        bar.set_prefix(stage.to_owned());
        bar.enable_steady_tick(TURN);
        self.bar = Some(bar);
    }

    fn advance(&mut self, done: Option<f64>, word: &str) {
        if let Some(bar) = &self.bar {
            done.into_iter().for_each(|d| bar.set_position((d.clamp(0.0, 1.0) * STEPS as f64) as u64));
            bar.set_message(word.to_owned());
        }
    }

    fn end(&mut self, _: &str, seconds: f64, result: &str) {
        if let Some(bar) = self.bar.take() {
            bar.set_position(STEPS);
            bar.set_style(Self::style("{prefix:<10} ✓ [{bar:28}] {msg}"));
            bar.finish_with_message(format!("{seconds:6.1} s  {result}"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_events_are_one_line_each() {
        let mut lines = Lines(Vec::new());
        lines.end("fold", 3.21, "55 iterations");
        assert_eq!(String::from_utf8(lines.0).unwrap(), "fold          3.2 s  55 iterations\n");
        let mut events = Events(Vec::new());
        events.begin("fold");
        assert_eq!(String::from_utf8(events.0).unwrap(), "{\"event\":\"begin\",\"stage\":\"fold\"}\n");
    }
}
