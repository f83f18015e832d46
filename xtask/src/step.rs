//! A step: a named check that passes, is skipped for a stated reason, or fails for one.
//!
//! All steps of a run are done even after one failed, so that one run shows everything; the closing table names them.

use std::process::ExitCode;
use std::time::{Duration, Instant};

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
#[derive(Debug, Default)]
pub struct Report {
    ended: Vec<(&'static str, Outcome, Duration)>,
}

impl Report {
    /// Does a step, announcing its start and its end.
    pub fn run(&mut self, step: Step) {
        eprintln!("==> {}", step.name);
        let start = Instant::now();
        let outcome = (step.work)();
        match &outcome {
            Ok(_) => {}
            Err(Failure::Found(reason)) => eprintln!("==> {} FAILED: {reason}", step.name),
            Err(Failure::Missing(remedy)) => eprintln!("==> {} cannot run: {remedy}", step.name),
        }
        self.ended.push((step.name, outcome, start.elapsed()));
    }

    /// Prints the closing table; the worst step gives the exit code.
    pub fn finish(self) -> ExitCode {
        eprintln!();
        for (name, outcome, time) in &self.ended {
            let said = match outcome {
                Ok(Passed::Done) => "ok".to_owned(),
                Ok(Passed::Skipped(reason)) => format!("skipped: {reason}"),
                Err(Failure::Found(reason)) => format!("FAILED: {}", first_line(reason)),
                Err(Failure::Missing(remedy)) => format!("CANNOT RUN: {}", first_line(remedy)),
            };
            eprintln!("{name:<14} {:>6.1} s  {said}", time.as_secs_f64());
        }
        ExitCode::from(self.exit_code())
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

fn first_line(text: &str) -> &str {
    text.lines().next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
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
    fn a_missing_tool_is_told_from_a_finding() {
        assert_eq!(exit_code_of(vec![Ok(Passed::Done), Ok(Passed::Skipped("no board".into()))]), 0);
        assert_eq!(exit_code_of(vec![Err(Failure::Missing("install it".into())), Ok(Passed::Done)]), 3);
        assert_eq!(exit_code_of(vec![Err(Failure::Missing("install it".into())), Err(Failure::found("x"))]), 1);
    }
}
