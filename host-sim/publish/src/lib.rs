//! State and events of followed batches go out: to a broker of MQTT, and to agents of MTConnect.
//!
//! | concern | where |
//! |---|---|
//! | the folders of `truepath batch` | [`follow`], [`summary`] |
//! | what is told of them | [`board`], [`message`] |
//! | topics | [`machine`] |
//! | a broker, near or away | [`mqtt`] |
//! | lines for agents | [`mtconnect`] |
//! | all of it together | [`publisher`] |
//!
//! Nothing here is part of any other command: whoever cuts, corrects or follows a batch never waits for a network.
//! `docs/publish.md` is for whoever sets it up.

pub mod board;
mod clock;
pub mod codes;
pub mod follow;
pub mod machine;
pub mod message;
pub mod mqtt;
pub mod mtconnect;
pub mod publisher;
pub mod summary;
