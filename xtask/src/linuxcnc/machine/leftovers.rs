//! What an earlier run left that crashed: processes, shared memory, LinuxCNC's lock file.
//!
//! Only processes of our own are ended: those that work in our folder, and the real-time process whose number the run
//! left there. Any other LinuxCNC on this computer is somebody's machine; it is named and left alone.

use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::user::User;
use crate::repository::{program, succeeds};
use crate::step::Failure;

/// File in the folder of the machine with the number of its real-time process.
pub const REAL_TIME: &str = "rtapi_app.pid";
/// What runs while a LinuxCNC runs.
const RUNNING: [&str; 3] = ["rtapi_app", "milltask", "linuxcncsvr"];
/// Keys of the shared memory and the semaphores of LinuxCNC's messages (linuxcnc.nml) and of its motion controller.
const KEYS: [&str; 6] = ["1001", "1002", "1003", "1004", "1005", "100"];
const LOCK: &str = "/tmp/linuxcnc.lock";
const REALTIME: &str = "/usr/lib/linuxcnc/realtime";
const PATIENCE: Duration = Duration::from_secs(20);

/// A process, from /proc.
struct Process {
    id: u32,
    name: String,
    ours: bool,
}

/// Ends what is ours and takes its shared memory away.
///
/// # Errors
/// Another LinuxCNC runs here, or ours does not end.
pub fn clean(user: &User, folder: &Path) -> Result<(), Failure> {
    let end = Instant::now() + PATIENCE;
    loop {
        let ours: Vec<Process> = processes(folder).into_iter().filter(|p| p.ours).collect();
        if ours.is_empty() {
            break;
        }
        if Instant::now() > end {
            let named: Vec<String> = ours.iter().map(|p| format!("{} {}", p.id, p.name)).collect();
            return Err(Failure::found(format!("these processes of the machine do not end: {}", named.join(", "))));
        }
        for process in ours {
            succeeds(user.program("kill", Path::new("/")).args(["-KILL", &process.id.to_string()]));
        }
        sleep(Duration::from_millis(100));
    }
    if let Some(other) = processes(folder).iter().find(|p| RUNNING.contains(&p.name.as_str())) {
        return Err(Failure::found(format!(
            "another LinuxCNC runs on this computer (process {} {}); only one can: end it first",
            other.id, other.name
        )));
    }
    if folder.exists() {
        succeeds(user.program(REALTIME, folder).arg("stop"));
    }
    for key in KEYS {
        // Another user's semaphore under the same key crashes LinuxCNC.
        succeeds(program("ipcrm").args(["-M", key]));
        succeeds(program("ipcrm").args(["-S", key]));
    }
    // Of a LinuxCNC that no longer runs, whoever started it.
    let _ = fs::remove_file(LOCK);
    let _ = fs::remove_file(folder.join(REAL_TIME));
    Ok(())
}

fn processes(folder: &Path) -> Vec<Process> {
    let real_time = fs::read_to_string(folder.join(REAL_TIME)).unwrap_or_default();
    let real_time: Vec<u32> = real_time.split_whitespace().filter_map(|id| id.parse().ok()).collect();
    let entries = fs::read_dir("/proc").into_iter().flatten().flatten();
    let ids = entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    ids.filter_map(|id: u32| {
        let at = Path::new("/proc").join(id.to_string());
        let name = fs::read_to_string(at.join("comm")).ok()?.trim().to_owned();
        // The third field of stat, behind the name in brackets: Z is a process that has ended already.
        let stat = fs::read_to_string(at.join("stat")).ok()?;
        let ended = stat.rsplit_once(')')?.1.trim_start().starts_with('Z');
        let inside = fs::read_link(at.join("cwd")).is_ok_and(|cwd| cwd.starts_with(folder));
        let ours = inside || (name == "rtapi_app" && real_time.contains(&id));
        (!ended).then_some(Process { id, name, ours })
    })
    .collect()
}
