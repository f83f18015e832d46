//! The program as a user calls it, in a folder of files.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use truepath_job::job::JobFile;
use truepath_job::pass::Pass;
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

/// Runs the program.
pub fn truepath(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_truepath")).args(arguments).current_dir(folder).output().expect("the program runs")
}

/// How a command that was refused has ended, by the code of its error: 2 for the command line itself.
pub fn refused(code: &str) -> Option<i32> {
    Some(if code == "C001" { 2 } else { 1 })
}

/// Bytes as text.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A folder that ends with it.
pub struct Workplace(tempfile::TempDir);

impl Workplace {
    /// With files by name.
    pub fn with(files: &[(&str, &str)]) -> Self {
        let place = Self(tempfile::tempdir().expect("a folder"));
        files.iter().for_each(|(name, text)| place.write(name, text));
        place
    }

    /// With files of a part of the demonstration.
    pub fn demo(part: &str, files: &[&str]) -> Self {
        let place = Self::with(&[]);
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("demo").join(part);
        for name in files {
            fs::copy(from.join(name), place.path().join(name)).expect("a copy");
        }
        place
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.0.path()
    }
    /// Writes a file.
    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.path().join(name), text).expect("written");
    }
    /// Reads one.
    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Runs a command, its words apart by blanks; its summary, or what it said.
    pub fn run(&self, arguments: &str) -> Result<Value, String> {
        let words: Vec<&str> = std::iter::once("--json").chain(arguments.split(' ')).collect();
        let done = truepath(self.path(), &words);
        match done.status.code() {
            Some(0) => Ok(serde_json::from_slice(&done.stdout).expect("JSON")),
            _ => Err(text(&done.stderr)),
        }
    }
    /// Runs a command that has to succeed; its summary.
    pub fn call(&self, arguments: &str) -> Value {
        self.run(arguments).unwrap_or_else(|said| panic!("{arguments}: {said}"))
    }

    /// Touches a part that the machine of plant.toml mills by job.toml, as it was programmed or by a corrected program: at these places,
    /// mm along the contour, at three heights. Writes the probe file.
    pub fn touch(&self, places: &[f64], program: Option<&str>, name: &str) {
        let machine: Machine = toml::from_str(&self.read("plant.toml")).expect("a machine");
        let pass = Pass::read(JobFile::read(&self.path().join("job.toml")).expect("a job")).expect("a pass");
        let commanded =
            program.map(|program| virtual_mill::commanded(&pass, self.read(program).as_bytes()).expect("a program"));
        let milled = virtual_mill::mill(&pass, &machine, commanded.as_deref()).expect("milled");
        self.write(name, virtual_mill::probe(&pass, &milled, places, &[0.1, 0.5, 0.9], 6.0).expect("touched"));
    }
}

/// The job of a rounded pocket in aluminium, cut `depth_mm` deep on a machine of this stiffness.
pub fn pocket_job(depth_mm: f64, stiffness_n_per_mm: u32) -> String {
    format!(
        "version = 1\nprogram = \"part.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 0.4\n[tool]\n\
         diameter_mm = 8.0\nteeth = 3\nhelix_deg = 35.0\n[cut]\naxial_depth_mm = {depth_mm:.1}\n[force]\n\
         material = \"al-6082-t6\"\n[machine]\nstiffness_x_n_per_mm = {stiffness_n_per_mm}\n\
         stiffness_y_n_per_mm = {stiffness_n_per_mm}\n[probe]\nball_diameter_mm = 2.0\n\
         format = \"linuxcnc-log\"\nz_reference = \"centre\"\n"
    )
}

/// A machine that the job does not state.
pub fn plant(compliance: &str) -> String {
    format!(
        "ktc_n_per_mm2 = 900\nkrc_n_per_mm2 = 250\nkte_n_per_mm = 10\nkre_n_per_mm = 13\nsize_exponent = 0.15\n\
         compliance_mm_per_n = {compliance}\nbend = 0.1\nprobe_noise_mm = 0.001\nseed = 3\n"
    )
}
