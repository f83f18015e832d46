//! A step: a named check that passes, is skipped for a stated reason, or fails for one.
//!
//! All steps of a run are done even after one failed, so that one run shows everything; the closing table names them.

use std::fs::File;
use std::path::Path;
use std::process::{Child, Command, ExitCode};

use crate::cost::{Cost, Meter};

/// How a step ended that did not fail.
#[derive(Debug)]
pub enum Passed {
    /// It was done.
    Done,
    /// It could not be done here and need not be, with the reason.
    Skipped(String),
}

/// How a step failed.
#[derive(Debug)]
pub enum Failure {
    /// The check found something.
    Found(String),
    /// A tool is missing, with the ways to get it.
    Missing(String),
}

impl Failure {
    /// A finding.
    pub fn found(text: impl Into<String>) -> Self {
        Self::Found(text.into())
    }
}

/// What a step returns.
pub type Outcome = Result<Passed, Failure>;

/// A named check.
pub struct Step<'a> {
    name: &'static str,
    work: Box<dyn FnOnce() -> Outcome + 'a>,
}

impl<'a> Step<'a> {
    /// A step by the name of its subcommand.
    pub fn new(name: &'static str, work: impl FnOnce() -> Outcome + 'a) -> Self {
        Self { name, work: Box::new(work) }
    }
}

/// The steps of this run.
#[derive(Debug)]
pub struct Report {
    ended: Vec<(&'static str, Outcome, Cost)>,
    meter: Meter,
}

impl Default for Report {
    fn default() -> Self {
        Self { ended: Vec::new(), meter: Meter::start() }
    }
}

impl Report {
    /// Does a step in a process of its own, and others meanwhile: one that waits more than it computes, as a machine that
    /// mills in real time does. What it says comes when it has ended.
    /// It goes into a file meanwhile.
    pub fn beside(&mut self, name: &'static str, command: &mut Command, said: &Path, others: impl FnOnce(&mut Self)) {
        eprintln!("==> {name}, beside the steps that follow");
        let clock = Meter::start();
        let begun = begin(command, said);
        others(self);
        // Of a child the time of the processor counts when it is waited for, and nothing else ends meanwhile.
        let processor = Meter::start();
        let outcome = begun.and_then(|mut child| {
            let status = child.wait().map_err(|e| Failure::found(e.to_string()))?;
            eprintln!("==> {name}\n{}", String::from_utf8_lossy(&std::fs::read(said).unwrap_or_default()));
            match status.code() {
                Some(0) => Ok(Passed::Done),
                Some(3) => Err(Failure::Missing(format!("see {}", said.display()))),
                _ => Err(Failure::found(format!("{status}: see {}", said.display()))),
            }
        });
        let cost = Cost { wall: clock.read().wall, processor: processor.read().processor };
        self.ended.push((name, outcome, cost));
    }

    /// Does a step, announcing its start and its end.
    pub fn run(&mut self, step: Step) {
        eprintln!("==> {}", step.name);
        let meter = Meter::start();
        let outcome = (step.work)();
        match &outcome {
            Ok(_) => {}
            Err(Failure::Found(reason)) => eprintln!("==> {} FAILED: {reason}", step.name),
            Err(Failure::Missing(remedy)) => eprintln!("==> {} cannot run: {remedy}", step.name),
        }
        self.ended.push((step.name, outcome, meter.read()));
    }

    /// Prints the closing table; the worst step gives the exit code.
    pub fn finish(self) -> ExitCode {
        eprintln!("\n{}", self.table(self.meter.read()));
        ExitCode::from(self.exit_code())
    }

    /// What became of each step, what it took on the clock and of the processors; `all` is what the run took.
    fn table(&self, all: Cost) -> String {
        let width = self.ended.iter().map(|(name, ..)| name.len()).max().unwrap_or(0);
        let row = |name: &str, cost: Cost, said: &str| {
            let (wall, processor) = (cost.wall.as_secs_f64(), cost.processor.as_secs_f64());
            format!("{name:<width$} {wall:>8.1} s {processor:>10.1} s  {said}\n")
        };
        let mut table = format!("{:<width$} {:>10} {:>12}\n", "step", "time", "processor");
        for (name, outcome, cost) in &self.ended {
            table += &row(name, *cost, &said(outcome));
        }
        if self.ended.len() > 1 {
            table += &row("all", all, "");
        }
        table.trim_end().to_owned()
    }

    fn exit_code(&self) -> u8 {
        let code = |outcome: &Outcome| match outcome {
            Ok(_) => 0,
            Err(Failure::Missing(_)) => 3,
            Err(Failure::Found(_)) => 1,
        };
        // A finding weighs more than a missing tool.
        let codes = || self.ended.iter().map(|(_, outcome, _)| code(outcome));
        if codes().any(|c| c == 1) { 1 } else { codes().max().unwrap_or(0) }
    }
}

/// Starts a command whose output goes into a file.
fn begin(command: &mut Command, said: &Path) -> Result<Child, Failure> {
    let failed = |e: std::io::Error| Failure::found(format!("{}: {e}", said.display()));
    let file = File::create(said).map_err(failed)?;
    let both = file.try_clone().map_err(failed)?;
    let program = command.get_program().to_string_lossy().into_owned();
    command.stdout(file).stderr(both).spawn().map_err(|e| Failure::found(format!("{program}: {e}")))
}

fn said(outcome: &Outcome) -> String {
    match outcome {
        Ok(Passed::Done) => "ok".to_owned(),
        Ok(Passed::Skipped(reason)) => format!("skipped: {reason}"),
        Err(Failure::Found(reason)) => format!("FAILED: {}", first_line(reason)),
        Err(Failure::Missing(remedy)) => format!("CANNOT RUN: {}", first_line(remedy)),
    }
}

fn first_line(text: &str) -> &str {
    text.trim_start().lines().next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn exit_code_of(outcomes: Vec<Outcome>) -> u8 {
        let mut report = Report::default();
        for outcome in outcomes {
            report.run(Step::new("step", || outcome));
        }
        report.exit_code()
    }

    #[test]
    fn a_failed_step_fails_the_run_and_the_steps_after_it_are_done() {
        let mut report = Report::default();
        report.run(Step::new("first", || Err(Failure::found("broken"))));
        report.run(Step::new("second", || Ok(Passed::Done)));
        assert_eq!(report.ended.len(), 2);
        assert_eq!(report.exit_code(), 1);
    }

    #[test]
    fn the_table_has_every_step_with_its_outcome_and_its_cost() {
        let cost =
            |wall, processor| Cost { wall: Duration::from_secs(wall), processor: Duration::from_millis(processor) };
        let ended = vec![
            ("lint", Ok(Passed::Done), cost(61, 100_500)),
            ("page", Err(Failure::found("\nfont missing\nmore")), cost(5, 1_000)),
            ("judge", Ok(Passed::Skipped("no judge".into())), cost(0, 0)),
        ];
        let wanted = [
            "step        time    processor",
            "lint      61.0 s      100.5 s  ok",
            "page       5.0 s        1.0 s  FAILED: font missing",
            "judge      0.0 s        0.0 s  skipped: no judge",
            "all       66.0 s      101.5 s",
        ];
        let report = Report { ended, meter: Meter::start() };
        assert_eq!(report.table(cost(66, 101_500)).lines().collect::<Vec<_>>(), wanted);
    }

    #[test]
    fn a_step_beside_others_ends_as_its_process_did_and_the_others_are_done() {
        let said = std::env::temp_dir().join(format!("step-{}.log", std::process::id()));
        for (code, wanted) in [("0", 0), ("1", 1), ("3", 3)] {
            let mut report = Report::default();
            let mut command = Command::new("sh");
            command.args(["-c", &format!("echo milled; exit {code}")]);
            report.beside("aside", &mut command, &said, |report| report.run(Step::new("other", || Ok(Passed::Done))));
            assert_eq!(report.ended.iter().map(|(name, ..)| *name).collect::<Vec<_>>(), ["other", "aside"]);
            assert_eq!(report.exit_code(), wanted);
        }
        assert_eq!(std::fs::read_to_string(&said).unwrap(), "milled\n");
        let mut report = Report::default();
        report.beside("nothing", &mut Command::new("/no/such/program"), &said, |_| {});
        std::fs::remove_file(&said).unwrap();
        assert_eq!(report.exit_code(), 1);
    }

    #[test]
    fn a_missing_tool_is_told_from_a_finding() {
        assert_eq!(exit_code_of(vec![Ok(Passed::Done), Ok(Passed::Skipped("no board".into()))]), 0);
        assert_eq!(exit_code_of(vec![Err(Failure::Missing("install it".into())), Ok(Passed::Done)]), 3);
        assert_eq!(exit_code_of(vec![Err(Failure::Missing("install it".into())), Err(Failure::found("x"))]), 1);
    }
}
