//! What the page calls, and what it is told while it waits.

use std::cell::RefCell;
use std::ffi::OsString;
use std::path::Path;

use truepath::{cli, streams};
use truepath_ground::files::in_memory::here::tree;

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// A task and the share of it that is done, 0…1.
    fn progress(task: *const u8, length: usize, share: f64);
    /// The message of a panic; the call that it happened in ends with a trap.
    fn fault(text: *const u8, length: usize);
}

thread_local! {
    /// What the page hands over, and the answer.
    static BUFFER: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// What the page handed over.
fn taken() -> Vec<u8> {
    BUFFER.with_borrow_mut(std::mem::take)
}

/// The same as text; a name that is no UTF-8 cannot come from a page.
fn text() -> String {
    String::from_utf8_lossy(&taken()).into_owned()
}

fn reply(bytes: Vec<u8>) {
    BUFFER.with_borrow_mut(|buffer| *buffer = bytes);
}

/// Tells the page of progress and of faults from now on; called once, before anything else.
#[unsafe(no_mangle)]
pub extern "C" fn begin() {
    // SAFETY: the page reads `length` bytes of the module's memory before it returns.
    streams::watch(|task, share| unsafe { progress(task.as_ptr(), task.len(), share) });
    std::panic::set_hook(Box::new(|panic| {
        let text = panic.to_string();
        // SAFETY: as above.
        unsafe { fault(text.as_ptr(), text.len()) };
    }));
}

/// A place for `length` bytes that the next call takes.
#[unsafe(no_mangle)]
pub extern "C" fn room(length: usize) -> *mut u8 {
    BUFFER.with_borrow_mut(|buffer| {
        buffer.clear();
        buffer.resize(length, 0);
        buffer.as_mut_ptr()
    })
}

/// Where the answer of the last call lies.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    BUFFER.with_borrow(|buffer| buffer.as_ptr())
}

/// Its bytes.
#[unsafe(no_mangle)]
pub extern "C" fn answer_length() -> usize {
    BUFFER.with_borrow(Vec::len)
}

/// Puts a file into memory: its name, `name` bytes long, then its bytes. 1 where a folder or a file is in its way.
#[unsafe(no_mangle)]
pub extern "C" fn put(name: usize) -> u32 {
    let mut bytes = taken();
    let content = bytes.split_off(name.min(bytes.len()));
    let written = tree().write(Path::new(&*String::from_utf8_lossy(&bytes)), content);
    u32::from(written.is_err())
}

/// The bytes of a file that the buffer names. 1 where there is none.
#[unsafe(no_mangle)]
pub extern "C" fn get() -> u32 {
    let name = text();
    let bytes = tree().read(Path::new(&name)).map(<[u8]>::to_vec);
    let missing = u32::from(bytes.is_err());
    reply(bytes.unwrap_or_default());
    missing
}

/// The names of all files, one a line.
#[unsafe(no_mangle)]
pub extern "C" fn list() {
    let names: Vec<String> = tree().files().map(|(path, _)| path.display().to_string()).collect();
    reply(names.join("\n").into_bytes());
}

/// Runs a command, whose words the buffer holds as a JSON array without the name of the program; the answer is its standard
/// output. Gives its exit code.
#[unsafe(no_mangle)]
pub extern "C" fn run() -> u32 {
    let words: Vec<String> = serde_json::from_slice(&taken()).unwrap_or_default();
    let words = std::iter::once("truepath".to_owned()).chain(words).map(OsString::from);
    let code = cli::run(words);
    let kept = streams::taken();
    SAID.with_borrow_mut(|said| *said = kept.error);
    reply(kept.out);
    u32::from(code)
}

thread_local! {
    /// What the last command wrote to standard error.
    static SAID: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// What the last command wrote to standard error.
#[unsafe(no_mangle)]
pub extern "C" fn said() {
    reply(SAID.take());
}
