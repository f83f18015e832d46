//! The command line for a web page: a module of WebAssembly that works on files in memory.
//!
//! It exports a handful of functions and calls two of the page; nothing else goes in or out, so it reaches neither disk nor
//! network. (What a library for pictures imports besides is never called, and the page gives it nothing.) Texts and bytes
//! pass through one buffer of the module: the page asks for
//! `room`, fills it and calls; the answer lies at `answer` (both in `bridge`) until the next call.
//! What happens to the files is the business of the commands themselves: there is no second implementation of anything here.
//!
//! For other targets the crate is empty.

#[cfg(target_family = "wasm")]
mod bridge;
#[cfg(target_family = "wasm")]
mod hypotenuse;
