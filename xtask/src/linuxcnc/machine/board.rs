//! The virtual board as LinuxCNC's user gets at it: QEMU with serial ports, and the sample machine at a slower servo
//! period that goes with it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::sample::Sample;
use crate::firmware::Board;
use crate::repository::{program, read, root, succeeds};
use crate::step::Failure;
use crate::toolchain::Toolchain;

/// Servo period. The emulator answers in a millisecond, but stands as long as a busy computer lets it.
pub const PERIOD_US: u64 = 40_000;
/// Folder of the links, in the machine's.
const LINKS: &str = "links";
/// For the firmware to come up.
const PATIENCE: Duration = Duration::from_secs(60);
/// Lines of the sample machine that are other ones at the slow period: file, begin of the line, what it becomes.
const SLOWER: [(&str, &str, &str); 8] = [
    ("sim/tests.ini", "SERVO_PERIOD =", "SERVO_PERIOD = 40000000"),
    ("sim/tests.ini", "BOARD =", "BOARD = port=LINKS/setpoint baud=921600\nCONFIG_PORT = LINKS/config"),
    // The drives' lag is shorter than the period.
    ("sim/truepath-mill-drives.hal", "setp drive.0.gain", "setp drive.0.gain 0.9999"),
    ("sim/truepath-mill-drives.hal", "setp drive.1.gain", "setp drive.1.gain 0.9999"),
    ("sim/truepath-mill-drives.hal", "setp drive.2.gain", "setp drive.2.gain 0.9999"),
    ("sim/truepath-mill-drives.hal", "net x-command", "setp truepath.link-wait 0.85\n"),
    ("sim/truepath-mill.hal", "setp spindle_mass.gain", "setp spindle_mass.gain 0.3"),
    ("truepath.hal", "setp watchdog.timeout-0", "setp watchdog.timeout-0 5.0"),
];

/// A running board. It ends when this is dropped.
#[derive(Debug)]
pub struct VirtualBoard {
    shell: Child,
    links: PathBuf,
}

impl VirtualBoard {
    /// Builds the firmware, starts it, gives it images and settings; those of the machine are as `--setting` takes them.
    ///
    /// # Errors
    /// The firmware does not build or does not come up, or the emulator is missing.
    pub fn start(sample: &Sample, truepath: &Path, images: &[PathBuf], machine: &[String]) -> Result<Self, Failure> {
        let elf = Board::Virtual.image().build(&Toolchain::find()?)?;
        for file in [&elf, &root().join("firmware/boards/run.sh")] {
            sample.put(file)?;
        }
        let (bin, links) = (sample.folder.join("bin"), sample.folder.join(LINKS));
        fs::create_dir_all(&links).map_err(|e| Failure::found(format!("{}: {e}", links.display())))?;
        sample.user.own(&sample.folder)?;
        // Not in the machine's folder: what runs there is LinuxCNC's, and is ended before it starts.
        let mut command = sample.user.program("sh", Path::new("/"));
        command.arg(bin.join("run.sh")).arg(bin.join("truepath-virtual")).arg("-pidfile").arg(links.join("pid"));
        command.env("TRUEPATH_SERIAL", "1").env("TRUEPATH_LINKS", &links);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let shell = command.spawn().map_err(|e| Failure::found(format!("run.sh: {e}")))?;
        let board = Self { shell, links };
        board.wait(truepath)?;
        for image in images {
            board.device(truepath, &["upload", &image.display().to_string(), "--activate"])?;
        }
        // Deadline and silence are long: what is tested is the controller's end.
        let period = PERIOD_US.to_string();
        let deadline = format!("deadline_us={}", PERIOD_US * 7 / 8);
        let machine: Vec<String> = machine.iter().map(|setting| format!("rewriter.{setting}")).collect();
        let mut words = vec!["settings", "--period-us", &period, &deadline, "silence_us=4000000"];
        words.extend(machine.iter().map(String::as_str));
        board.device(truepath, &words)?;
        Ok(board)
    }

    fn device(&self, truepath: &Path, words: &[&str]) -> Result<String, Failure> {
        read(program(truepath).args(["device", "--port"]).arg(self.links.join("config")).args(words))
    }

    fn wait(&self, truepath: &Path) -> Result<(), Failure> {
        let end = Instant::now() + PATIENCE;
        while !self.links.join("config").exists()
            || !succeeds(program(truepath).args(["device", "--port"]).arg(self.links.join("config")).arg("info"))
        {
            if Instant::now() > end {
                return Err(Failure::Missing(
                    "the virtual board does not come up; is the emulator there? apt-get install qemu-system-arm".into(),
                ));
            }
            sleep(Duration::from_millis(100));
        }
        Ok(())
    }
}

impl Drop for VirtualBoard {
    fn drop(&mut self) {
        // Without a number there is no emulator; the shell ends with it.
        if let Ok(id) = fs::read_to_string(self.links.join("pid")) {
            succeeds(program("kill").args(["-CONT", id.trim()]));
            succeeds(program("kill").arg(id.trim()));
        }
        let _ = self.shell.wait();
    }
}

/// Makes the sample machine one with a board, at the slow period. After [`Sample::ready`].
///
/// # Errors
/// A file cannot be read or written, or lacks a line.
pub fn slow_down(sample: &Sample) -> Result<(), Failure> {
    let links = sample.folder.join(LINKS).display().to_string();
    for (file, begin, becomes) in SLOWER {
        let path = sample.folder.join(file);
        let wrong = |why: String| Failure::found(format!("{}: {why}", path.display()));
        let text = fs::read_to_string(&path).map_err(|e| wrong(e.to_string()))?;
        let becomes = becomes.replace("LINKS", &links);
        let text = changed(&text, begin, &becomes).ok_or_else(|| wrong(format!("there is no line {begin}")))?;
        fs::write(&path, text).map_err(|e| wrong(e.to_string()))?;
    }
    sample.user.own(&sample.folder)
}

/// A text with one line exchanged; one that ends with a line feed goes before it.
fn changed(text: &str, begin: &str, becomes: &str) -> Option<String> {
    let found = text.lines().position(|line| line.starts_with(begin))?;
    let lines = text.lines().enumerate().map(|(place, line)| match (place == found, becomes.ends_with('\n')) {
        (true, true) => format!("{becomes}{line}\n"),
        (true, false) => format!("{becomes}\n"),
        (false, _) => format!("{line}\n"),
    });
    Some(lines.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_exchanged_or_gets_one_before_it() {
        assert_eq!(changed("a\nb 1\nc\n", "b", "d"), Some("a\nd\nc\n".to_owned()));
        assert_eq!(changed("a\nb 1\nc\n", "b", "d\n"), Some("a\nd\nb 1\nc\n".to_owned()));
        assert_eq!(changed("a\n", "b", "d"), None);
    }
}
