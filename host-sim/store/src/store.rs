//! A store that is open.

use serde::Serialize;
use truepath_correction::learning::Facts;
use truepath_correction::shop::{Setting, Shop};
use truepath_ground::codes::C001;
use truepath_ground::diagnostics::{Failure, InputError};

use crate::add::{Added, Setup, add};
use crate::backend::{Backend, Make, open, whole};
use crate::codes::O008;
use crate::export::{Choice, choices, file_of};
use crate::folder::PartFolder;
use crate::members::members;
use crate::place::Place;
use crate::schema::{MIGRATIONS, ROLES, migrate, refuse_other};
use crate::status::{Status, count_again, status};

/// An open store of the version of this program.
pub struct Store {
    place: Place,
    on: Box<dyn Backend>,
}

/// What bringing a store up has done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Migrated {
    /// The version before; `None` where there was no store.
    pub before: Option<i64>,
    /// The version now.
    pub version: i64,
}

impl Store {
    /// Makes a store, or brings the one that is there up; `roles` also makes the roles of a server.
    ///
    /// # Errors
    /// `O001` where it cannot be reached, `O003` for a store of a newer program, `O004` where nothing can be written,
    /// `C001` for roles in a file.
    pub fn init(place: &Place, roles: bool) -> Result<Migrated, Failure> {
        if roles && place.file().is_some() {
            let help = "leave --roles out: who may read or write a file is said by the rights of the file";
            let found = format!("--roles, and {place} is a file");
            return Err(InputError::new(C001, found, "a database of a server", help).into());
        }
        let mut on = open(place, Make::New)?;
        let (before, version) = migrate(on.as_mut(), place, MIGRATIONS)?;
        if roles {
            whole(on.as_mut(), |on| on.script(ROLES))?;
        }
        Ok(Migrated { before, version })
    }

    /// Brings a store up to the version of this program.
    ///
    /// # Errors
    /// As [`Store::init`], and `O002` where there is none.
    pub fn migrate(place: &Place) -> Result<Migrated, Failure> {
        let mut on = open(place, Make::Nothing)?;
        if crate::schema::version(on.as_mut())?.is_none() {
            refuse_other(on.as_mut(), place)?;
        }
        let (before, version) = migrate(on.as_mut(), place, MIGRATIONS)?;
        Ok(Migrated { before, version })
    }

    /// Opens a store.
    ///
    /// # Errors
    /// `O001` where it cannot be reached, `O002` where there is none, `O003` for another version.
    pub fn open(place: &Place) -> Result<Self, Failure> {
        let mut on = open(place, Make::Nothing)?;
        refuse_other(on.as_mut(), place)?;
        Ok(Self { place: place.clone(), on })
    }

    /// Puts the histories of one part in, in one transaction. What is already in it stays as it is, so that doing it again changes
    /// nothing.
    ///
    /// # Errors
    /// `O001` when others hold it for too long, `O004` when it takes nothing. Nothing of the part is then in it.
    pub fn add(&mut self, part: &PartFolder, setup: &Setup) -> Result<Vec<Added>, Failure> {
        whole(self.on.as_mut(), |on| part.contours.iter().map(|found| add(on, found, setup)).collect())
    }

    /// The newest histories of a job: those that no other one goes on from, the last stored first.
    ///
    /// # Errors
    /// `O001` where the store does not answer.
    pub fn newest(&mut self, facts: &Facts) -> Result<Vec<Choice>, Failure> {
        choices(self.on.as_mut(), facts)
    }

    /// What the jobs of other programs say that were cut on this machine or make, or from this material, and the number of the newest
    /// estimate among them.
    ///
    /// # Errors
    /// `O001` where the store does not answer.
    pub fn shop(&mut self, facts: &Facts, wanted: &Setting) -> Result<(Shop, Option<i64>), Failure> {
        members(self.on.as_mut(), facts, wanted)
    }

    /// The `history.json` of a number, byte for byte.
    ///
    /// # Errors
    /// `O006` where there is none, `O008` where its rows do not give back the file that was stored.
    pub fn history(&mut self, number: i64) -> Result<Vec<u8>, Failure> {
        file_of(self.on.as_mut(), &self.place, number)
    }

    /// What is in it, with the last so many parts.
    ///
    /// # Errors
    /// `O001` where the store does not answer.
    pub fn status(&mut self, last: u32) -> Result<Status, Failure> {
        status(self.on.as_mut(), &self.place, last)
    }

    /// Reads all of it: pages, sums, and every history. Gives the number of histories.
    ///
    /// # Errors
    /// `O008` with the first thing that is wrong.
    pub fn check(&mut self) -> Result<u64, Failure> {
        if let Some(damage) = self.on.damage()? {
            return Err(O008.error(format!("{} is damaged: {damage}", self.place), "sound pages").into());
        }
        count_again(self.on.as_mut(), &self.place)?;
        let mut after = 0;
        let mut histories = 0;
        // Each for itself, as all of them need not fit into memory.
        while let Some(number) = crate::export::next_after(self.on.as_mut(), after)? {
            self.history(number)?;
            after = number;
            histories += 1;
        }
        Ok(histories)
    }
}
