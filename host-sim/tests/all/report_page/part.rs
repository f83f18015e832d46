//! A part in a folder of its own: milled by the virtual machine, touched, corrected.

use std::fs;
use std::path::{Path, PathBuf};

use truepath::command::{correct, learn, simulate};
use truepath_ground::diagnostics::{Failure, Form};
use truepath_ground::units::mm;
use truepath_job::job::{JobFile, Route};
use truepath_job::pass::Pass;
use truepath_plant::Milled;
use truepath_trial::virtual_mill;

const DEMO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/demo");

pub struct Part {
    folder: tempfile::TempDir,
}

/// The value, or the diagnostic as a user would see it.
pub fn shown<T>(result: Result<T, Failure>) -> T {
    result.unwrap_or_else(|failure| panic!("{}", failure.render(Form::Plain)))
}

impl Part {
    /// A part of the demonstration; `more` is added to its job.
    pub fn of_the_demonstration(name: &str, more: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let from = Path::new(DEMO).join(name);
        for file in ["program.nc", "plant.toml"] {
            fs::copy(from.join(file), folder.path().join(file)).unwrap();
        }
        let job = fs::read_to_string(from.join("job.toml")).unwrap();
        fs::write(folder.path().join("job.toml"), format!("{job}\n{more}")).unwrap();
        Self { folder }
    }

    pub fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn pass(&self) -> Pass {
        shown(JobFile::read(&self.at("job.toml")).map_err(Failure::from).and_then(Pass::read))
    }

    /// Mills it, with a corrected program where one is named.
    pub fn milled(&self, corrected: Option<&str>) -> Milled {
        let machine = shown(simulate::read_machine(&self.at("plant.toml")));
        let pass = self.pass();
        match corrected {
            None => shown(virtual_mill::mill(&pass, &machine, None)),
            Some(name) => shown(virtual_mill::mill_program(&pass, &machine, &fs::read(self.at(name)).unwrap())),
        }
    }

    /// Touches it at three heights of some places.
    pub fn touched(&self, milled: &Milled, places: &[f64], file: &str) {
        self.touched_along(&self.pass(), milled, places, file);
    }

    /// The same along another pass.
    pub fn touched_along(&self, pass: &Pass, milled: &Milled, places: &[f64], file: &str) {
        let ball_mm = mm(pass.job.require_probe().unwrap().ball_diameter);
        let text = shown(virtual_mill::probe(pass, milled, places, &[0.1, 0.5, 0.9], ball_mm));
        fs::write(self.at(file), text).unwrap();
    }

    pub fn correct(&self, probe: &str, out: &str, route: Option<Route>) {
        self.correct_after(None, probe, out, route);
    }

    /// Corrects the pass that follows the one of another job, which the points are of.
    pub fn correct_after(&self, first_pass: Option<&Path>, probe: &str, out: &str, route: Option<Route>) {
        let options = correct::Options {
            job: self.at("job.toml"),
            probe: Some(self.at(probe)),
            output: self.at(out),
            route,
            first_pass: first_pass.map(Path::to_owned),
            ..correct::Options::default()
        };
        shown(correct::run(&options, &mut |_| ()));
    }

    pub fn learn(&self, probe: &str, from: &str, out: &str) {
        let options = learn::Options {
            job: self.at("job.toml"),
            probe: Some(self.at(probe)),
            from: self.at(from),
            output: self.at(out),
            ..learn::Options::default()
        };
        shown(learn::run(&options, &mut |_| ()));
    }

    pub fn simulate(&self, plant: bool, out: &str) {
        let plant = plant.then(|| self.at("plant.toml"));
        let (job, output) = (self.at("job.toml"), self.at(out));
        let options = simulate::Options { job, plant, output, ..simulate::Options::default() };
        shown(simulate::run(&options));
    }
}

/// Places round the pocket of the demonstration, its corners among them.
pub const ROUND: [f64; 5] = [12.0, 45.0, 92.0, 145.0, 180.0];

/// The pocket of the demonstration, touched.
pub fn pocket(more: &str) -> Part {
    let part = Part::of_the_demonstration("pocket", more);
    part.touched(&part.milled(None), &ROUND, "probe.txt");
    part
}
