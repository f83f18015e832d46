//! A text that is kept in memory until it is whole.
//!
//! To be given the memory of a long text, page by page, takes a sixth of the time that making it takes. So it is gathered on another
//! core: pieces go there as they come, and come back to be filled again.

use std::io::{self, Write};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{Builder, scope};

use truepath_ground::diagnostics::Failure;

/// Where the pieces go.
pub(super) struct Pieces {
    full: Sender<Vec<u8>>,
    emptied: Receiver<Vec<u8>>,
}

impl Write for Pieces {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut piece = self.emptied.try_recv().unwrap_or_default();
        piece.clear();
        piece.extend_from_slice(bytes);
        self.full.send(piece).map_err(io::Error::other)?;
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// What `write` answers, and the text that it has written.
#[cfg(not(target_family = "wasm"))]
pub(super) fn text_of<T>(write: impl FnOnce(&mut Pieces) -> T) -> Result<(T, Vec<u8>), Failure> {
    let (full, pieces) = channel::<Vec<u8>>();
    let (back, emptied) = channel();
    let gather = move || {
        let mut text = Vec::new();
        for piece in pieces {
            text.extend_from_slice(&piece);
            // Nobody waits for the last ones.
            let _ = back.send(piece);
        }
        text
    };
    scope(|scope| {
        let failed = |what: &str| Failure::Internal(format!("the text cannot be gathered: {what}"));
        let gathering = Builder::new().spawn_scoped(scope, gather).map_err(|error| failed(&error.to_string()))?;
        let answer = write(&mut Pieces { full, emptied });
        Ok((answer, gathering.join().map_err(|_| failed("its thread has ended"))?))
    })
}

/// In a browser there is one core.
#[cfg(target_family = "wasm")]
pub(super) fn text_of<T>(write: impl FnOnce(&mut Vec<u8>) -> T) -> Result<(T, Vec<u8>), Failure> {
    let mut text = Vec::new();
    let answer = write(&mut text);
    Ok((answer, text))
}

#[cfg(all(test, not(target_family = "wasm")))]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_gathered_in_their_order() {
        let (answer, text) = text_of(|out| (0..1000).try_for_each(|n| writeln!(out, "{n}"))).expect("a thread");
        let expected: String = (0..1000).map(|n| format!("{n}\n")).collect();
        assert_eq!((answer.is_ok(), String::from_utf8(text).unwrap()), (true, expected));
    }
}
