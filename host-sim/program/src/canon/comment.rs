//! What a comment makes the reference print.
//!
//! Limits: the files of LOGOPEN and PROBEOPEN are not written.

use truepath_core::gcode::{Comment, CommentKind, MachineParameters};

/// What is printed.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Remark {
    /// A call with a quoted text.
    Call(&'static str, String),
    /// A line of its own.
    Bare(String),
}

impl Remark {
    /// Of the body of a comment in parentheses; `None` for a DEBUG comment while `#5599` is 0.
    pub(super) fn of(body: &[u8], parameters: &dyn MachineParameters) -> Option<Self> {
        let comment = Comment::of(body);
        if comment.kind == CommentKind::Debug && parameters.memory().given(5599) == Some(0.0) {
            return None;
        }
        let text = || {
            let mut text = String::new();
            // Writing to memory does not fail.
            let _ = comment.write(parameters, &mut text);
            text
        };
        Some(match comment.kind {
            CommentKind::Message | CommentKind::Debug => Self::Call("MESSAGE", text()),
            CommentKind::Log => Self::Call("LOG", text()),
            CommentKind::Print => Self::Bare(text()),
            _ => Self::Call("COMMENT", String::from_utf8_lossy(body).trim_start().to_owned()),
        })
    }
}

#[cfg(test)]
mod tests {
    use truepath_core::gcode::{HostMemory, Memory};

    use super::*;

    struct Machine<'m>(Memory<'m>);

    impl MachineParameters for Machine<'_> {
        fn number(&self, number: u32) -> Option<f64> {
            (number == 5420).then_some(1.5)
        }
        fn named(&self, _name: &[u8]) -> Option<f64> {
            None
        }
        fn memory(&self) -> &Memory<'_> {
            &self.0
        }
    }

    fn remark(body: &str) -> Remark {
        let mut buffers = Box::new(HostMemory::new());
        let mut memory = buffers.lend();
        memory.set(31, 2.25).expect("room");
        Remark::of(body.as_bytes(), &Machine(memory)).expect("shown")
    }

    #[test]
    fn debug_comments_are_silent_while_their_switch_is_off() {
        let mut buffers = Box::new(HostMemory::new());
        let mut memory = buffers.lend();
        memory.set(5599, 0.0).expect("room");
        let machine = Machine(memory);
        assert_eq!(Remark::of(b"DEBUG, x", &machine), None);
        assert!(Remark::of(b"MSG, x", &machine).is_some());
    }

    #[test]
    fn every_kind_of_comment_has_its_call() {
        let shown = |call, text: &str| Remark::Call(call, text.to_owned());
        assert_eq!(remark("DEBUG, #5420 #31"), shown("MESSAGE", " 1.500000 2.250000"));
        assert_eq!(remark("log,%d#31"), shown("LOG", "2"));
        assert_eq!(remark("msg, #31"), shown("MESSAGE", " #31"));
        assert_eq!(remark("print,hello"), Remark::Bare("hello".to_owned()));
        assert_eq!(remark("  a, b"), shown("COMMENT", "a, b"));
    }
}
