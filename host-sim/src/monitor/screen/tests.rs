//! A view that panics, on a real pseudo-terminal: a process of its own by way of this test binary.

use std::io::Read;

use portable_pty::{CommandBuilder, PtySize, native_pty_system};

use super::Screen;

#[test]
#[ignore = "called by the other, in a process of its own on a terminal of its own"]
fn child_whose_view_panics() {
    let mut screen = Screen::open().unwrap();
    screen.draw(|frame| frame.render_widget("drawn", frame.area())).unwrap();
    screen.draw(|_| panic!("on purpose")).unwrap();
}

#[test]
fn a_panic_gives_the_terminal_back_before_it_tells_of_itself() {
    let pair = native_pty_system().openpty(PtySize::default()).unwrap();
    let modes = |master: &dyn portable_pty::MasterPty| format!("{:?}", master.get_termios().unwrap());
    let before = modes(&*pair.master);
    let mut command = CommandBuilder::new(std::env::current_exe().unwrap());
    command.args(["--exact", "monitor::screen::tests::child_whose_view_panics", "--ignored", "--nocapture"]);
    let mut child = pair.slave.spawn_command(command).unwrap();
    let mut reader = pair.master.try_clone_reader().unwrap();
    let output = std::thread::spawn(move || {
        let mut all = Vec::new();
        let mut buffer = [0; 4096];
        // On Linux the end of a terminal is an error.
        while let Ok(count @ 1..) = reader.read(&mut buffer) {
            all.extend_from_slice(&buffer[..count]);
        }
        String::from_utf8_lossy(&all).into_owned()
    });
    assert!(!child.wait().unwrap().success());
    assert_eq!(modes(&*pair.master), before);
    drop(pair.slave);
    let output = output.join().unwrap();
    let at = |text: &str| output.find(text).unwrap_or_else(|| panic!("no {text:?} in {output:?}"));
    let [taken, drawn, back, shown, told] = ["\x1b[?1049h", "drawn", "\x1b[?1049l", "\x1b[?25h", "on purpose"].map(at);
    assert!(taken < drawn && drawn < back && back < told && shown < told, "{output:?}");
}
