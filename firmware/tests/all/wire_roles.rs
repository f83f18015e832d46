//! Who may ask what: roles, logins and sessions over the configuration link.

use crate::wire_modes::asks;
use crate::wire_support;
use ed25519_dalek::SigningKey;
use truepath_core::checksum::crc32;
use truepath_core::image::{DeviceClasses, PublicKey, Rights, Role, SignatureError};
use truepath_core::link::{
    AccessError, Ask, Change, Denial, DeviceSession, DeviceSettings, MOST_TRIES, Reply, ResetCause, Response,
    SESSION_SILENCE_US, SessionEnd, TRY_WINDOW_US, decode,
};
use truepath_core::rewrite::Mode;
use truepath_fw::flash::{Cut, LEDGER_SECTORS, Moment, SECTOR_BYTES};
use wire_support::*;

const OPERATOR: Rights = Rights { role: Role::Operate, signs: false, firmware: false };

/// A device with a key of an engineer (1) and one of an operator (2), at which nobody logs in by himself.
fn provisioned() -> Rig {
    let mut rig = Rig::new();
    rig.logs_in = false;
    rig.done(Ask::Provision(public(&owner(1)))).unwrap();
    rig.done(Ask::ProvisionAs { key: public(&owner(2)), rights: OPERATOR }).unwrap();
    rig
}

fn session(rig: &mut Rig) -> DeviceSession {
    let Reply::Session(session) = rig.ask(Ask::Session).unwrap() else { panic!() };
    session
}

fn access<T>(error: AccessError) -> Result<T, Denial> {
    Err(Denial::Access(error))
}

fn needs<T>(needed: Role) -> Result<T, Denial> {
    access(AccessError::Role { needed })
}

fn ended<T>(why: SessionEnd) -> Result<T, Denial> {
    access(AccessError::Ended { why })
}

fn forged<T>(owner: &SigningKey) -> Result<T, Denial> {
    access(AccessError::Forged { key: public(owner).id() })
}

/// The newest entries of the log.
fn newest(rig: &mut Rig) -> Vec<(Change, Option<truepath_core::image::KeyId>, u16)> {
    let next = rig.logged_next();
    let Reply::Log { entries, .. } = rig.ask(Ask::Log { from: next.saturating_sub(3) }).unwrap() else { panic!() };
    entries.iter().map(|entry| (entry.change, entry.by, entry.refused)).collect()
}

#[test]
fn every_request_is_taken_from_its_least_role_on_and_denied_below_without_any_effect() {
    let image = signed(&image_of(part::straight()), &owner(1), DeviceClasses::ALL);
    let asks = asks(&image);
    for ask in &asks {
        for role in [None, Some(Role::Read), Some(Role::Operate), Some(Role::Engineer)] {
            let mut rig = provisioned();
            if let Some(role) = role {
                rig.log_in(&owner(1), role).unwrap();
            }
            rig.wait(10);
            let (settings, slots, operations) = (rig.settings(), rig.slots(), rig.operations());
            let found = rig.ask(*ask).map(|_| ());
            let denied = matches!(found, Err(Denial::Access(AccessError::Role { .. })));
            assert_eq!(denied, role.unwrap_or_default() < ask.least(), "{ask:?} as {role:?}");
            if denied {
                assert_eq!(found, needs(ask.least()));
                rig.wait(10);
                assert_eq!((settings, slots, operations), (rig.settings(), rig.slots(), rig.operations()), "{ask:?}");
                assert_eq!(rig.mode(), Mode::Off);
            }
        }
        let mut open = Rig::new();
        open.logs_in = false;
        assert!(!matches!(open.ask(*ask), Err(Denial::Access(AccessError::Role { .. }))), "{ask:?} of an open device");
    }
    let least = |role| asks.iter().filter(|ask| ask.least() == role).count();
    assert_eq!(Role::ALL.map(least), [20, 7, 9]);
}

#[test]
fn a_login_gives_the_role_to_the_requests_of_its_session_and_to_no_others() {
    let mut rig = provisioned();
    let other = DeviceSettings { silence_us: 30_000, ..DeviceSettings::at_1_khz() };
    assert_eq!((session(&mut rig).open, session(&mut rig).role), (false, Role::Read));
    assert_eq!(rig.done(Ask::Configure(other)), needs(Role::Engineer));
    let number = rig.log_in(&owner(1), Role::Engineer).unwrap();
    rig.done(Ask::Configure(other)).unwrap();
    let found = session(&mut rig);
    assert_eq!((found.role, found.key), (Role::Engineer, Some(public(&owner(1)).id())));
    assert_eq!(found.rights[..3], [Rights::default(), OPERATOR, Rights::default()]);
    // Who only has the wire has nothing of it, and cannot end it.
    rig.session = None;
    assert_eq!(rig.done(Ask::Deactivate), needs(Role::Engineer));
    rig.done(Ask::Logout).unwrap();
    for guess in [0, 1, number ^ 1, !number] {
        rig.session = Some(guess);
        assert_eq!(rig.ask(Ask::Status).map(|_| ()), ended(SessionEnd::Unknown));
    }
    rig.session = Some(number);
    rig.done(Ask::Deactivate).unwrap();
    rig.done(Ask::Logout).unwrap();
    assert_eq!(rig.ask(Ask::Status).map(|_| ()), ended(SessionEnd::Logout));
    rig.session = None;
    let by = Some(public(&owner(1)).id());
    let entries = [(Change::LoggedIn, by, 0), (Change::Configured, by, 0), (Change::LoggedOut, by, 0)];
    assert_eq!(newest(&mut rig), entries);
}

#[test]
fn an_operator_arms_and_disarms_and_neither_uploads_nor_configures_nor_signs() {
    let mut rig = provisioned();
    rig.log_in(&owner(1), Role::Engineer).unwrap();
    let mine = signed(&image_of(part::straight()), &owner(1), DeviceClasses::ALL);
    let slot = rig.upload(&mine).unwrap();
    rig.activate(slot, name(&mine)).unwrap();
    let by_operator = signed(&image_of(straight(0)), &owner(2), DeviceClasses::ALL);
    let signs_nothing = Denial::Untrusted(SignatureError::SignsNothing { key: public(&owner(2)).id() });
    assert_eq!(rig.upload(&by_operator), Err(signs_nothing));
    let beyond = AccessError::Beyond { key: public(&owner(2)).id(), most: Role::Operate };
    assert_eq!(rig.log_in(&owner(2), Role::Engineer), access(beyond));
    rig.log_in(&owner(2), Role::Operate).unwrap();
    rig.enable();
    rig.arm(1).unwrap();
    rig.done(Ask::Disarm).unwrap();
    assert_eq!(rig.done(Ask::Deactivate), needs(Role::Engineer));
    assert_eq!(rig.begin(&mine), needs(Role::Engineer));
    // A reset keeps the rights, and no session.
    rig.reset(ResetCause::PowerOn);
    assert_eq!(session(&mut rig).rights[1], OPERATOR);
    assert_eq!(rig.done(Ask::Restart { watchdog: false }), needs(Role::Operate));
    assert_eq!(rig.log_in(&owner(2), Role::Engineer), access(beyond));
}

#[test]
fn an_answer_is_good_for_one_challenge_device_key_and_role_and_for_one_try() {
    let mut rig = provisioned();
    let (device, nonce) = rig.challenge();
    let right = login(&owner(1), Role::Engineer, &device, &nonce);
    let Ask::Login { key, signature, .. } = right else { panic!() };
    // For another role, key, device, challenge; changed in any bit: each with a challenge of its own.
    let fresh = |rig: &mut Rig| rig.challenge();
    let mut tries: Vec<Ask<'static>> = vec![Ask::Login { key, role: Role::Operate, signature }];
    tries.push(login(&owner(1), Role::Engineer, &[4; 12], &nonce));
    tries.push(login(&owner(1), Role::Engineer, &device, &[9; 32]));
    let mut flipped = signature;
    flipped[1][31] ^= 0x10;
    tries.push(Ask::Login { key, role: Role::Engineer, signature: flipped });
    for ask in tries {
        assert_eq!(rig.ask(ask).map(|_| ()), forged(&owner(1)), "{ask:?}");
        assert_eq!(rig.ask(right).map(|_| ()), access(AccessError::NoChallenge), "it was used up");
        fresh(&mut rig);
    }
    rig.now_us += TRY_WINDOW_US;
    // In the name of the key by another; of a key that is not there.
    let (device, nonce) = rig.challenge();
    let Ask::Login { signature, .. } = login(&owner(2), Role::Engineer, &device, &nonce) else { panic!() };
    assert_eq!(rig.ask(Ask::Login { key, role: Role::Engineer, signature }).map(|_| ()), forged(&owner(1)));
    let unknown = AccessError::UnknownKey { key: public(&owner(3)).id() };
    assert_eq!(rig.log_in(&owner(3), Role::Read), access(unknown));
    // The right one, and then the same packet again behind another request and behind a new challenge.
    let (device, nonce) = rig.challenge();
    let right = login(&owner(1), Role::Engineer, &device, &nonce);
    assert!(matches!(rig.ask(right), Ok(Reply::LoggedIn { .. })));
    rig.session = None;
    assert_eq!(rig.ask(right).map(|_| ()), access(AccessError::NoChallenge));
    rig.challenge();
    assert_eq!(rig.ask(right).map(|_| ()), forged(&owner(1)));
}

#[test]
fn the_answer_to_a_login_is_given_again_to_the_same_packet_while_its_session_lasts() {
    let mut rig = provisioned();
    let (device, nonce) = rig.challenge();
    let packet = request(700, login(&owner(1), Role::Operate, &device, &nonce));
    let first = rig.raw(&packet);
    assert_eq!(rig.raw(&packet), first, "it was lost on the way");
    rig.now_us += SESSION_SILENCE_US + 1;
    rig.raw(&request(701, Ask::Hello));
    let mut again = rig.raw(&packet);
    let denied = decode::<Response<'_>>(&mut again[0]).unwrap().answer.map(|_| ());
    assert_eq!(denied, access(AccessError::NoChallenge));
}

#[test]
fn challenges_never_come_twice_over_resets_nor_within_one_time() {
    let mut rig = provisioned();
    let mut all = std::collections::BTreeSet::new();
    for _ in 0..40 {
        for _ in 0..25 {
            assert!(all.insert(rig.challenge().1));
        }
        rig.reset(ResetCause::Watchdog);
    }
    assert_eq!(all.len(), 1_000);
    let Reply::Challenge { random, device, .. } = rig.ask(Ask::Challenge).unwrap() else { panic!() };
    assert_eq!((random, device), (false, [3; 12]), "this board has no generator, and says so");
}

#[test]
fn a_session_ends_by_silence_a_new_login_a_revoked_key_and_a_reset_and_whoever_had_it_is_told() {
    let mut rig = provisioned();
    rig.log_in(&owner(1), Role::Engineer).unwrap();
    rig.now_us += SESSION_SILENCE_US;
    rig.done(Ask::Deactivate).unwrap();
    rig.now_us += SESSION_SILENCE_US + 1;
    for _ in 0..2 {
        assert_eq!(rig.done(Ask::Deactivate), ended(SessionEnd::Silence));
    }
    let first = rig.log_in(&owner(1), Role::Engineer).unwrap();
    let second = rig.log_in(&owner(2), Role::Operate).unwrap();
    assert_ne!(first, second);
    rig.session = Some(first);
    assert_eq!(rig.ask(Ask::Status).map(|_| ()), ended(SessionEnd::NewLogin), "not silently");
    rig.session = None;
    let next = rig.logged_next();
    let Reply::Log { entries, .. } = rig.ask(Ask::Log { from: next - 1 }).unwrap() else { panic!() };
    let last = entries.last().unwrap();
    let [one, two] = [1, 2].map(|seed| Some(public(&owner(seed)).id()));
    assert_eq!((last.change, last.by, last.key, last.value), (Change::LoggedIn, two, one, Role::Operate as u32));
    rig.done(Ask::Revoke(public(&owner(2)).id())).unwrap();
    rig.session = Some(second);
    assert_eq!(rig.ask(Ask::Status).map(|_| ()), ended(SessionEnd::Revoked));
    let unknown = AccessError::UnknownKey { key: public(&owner(2)).id() };
    assert_eq!(rig.log_in(&owner(2), Role::Read), access(unknown));
    let third = rig.log_in(&owner(1), Role::Read).unwrap();
    rig.reset(ResetCause::Pin);
    rig.session = Some(third);
    assert_eq!(rig.ask(Ask::Status).map(|_| ()), ended(SessionEnd::Unknown));
}

#[test]
fn five_logins_a_minute_are_tried_and_who_tries_on_fills_no_log() {
    let mut rig = provisioned();
    let before = rig.logged_next();
    let wrong = |rig: &mut Rig| {
        let (device, _) = rig.challenge();
        let ask = login(&owner(1), Role::Engineer, &device, &[0; 32]);
        rig.ask(ask).map(|_| ())
    };
    let mut tried = 0;
    for second in 0..600u64 {
        match wrong(&mut rig) {
            Err(Denial::Access(AccessError::TooManyTries { wait_s })) => {
                assert_eq!(u64::from(wait_s), 60 - second % 60);
                assert!(rig.log_in(&owner(1), Role::Engineer).is_err(), "the right one neither");
            }
            found => {
                assert_eq!(found, forged(&owner(1)));
                tried += 1;
            }
        }
        rig.wait(1_000);
    }
    assert_eq!(tried, 10 * u32::from(MOST_TRIES));
    assert_eq!(rig.logged_next(), before + 1, "one entry for all of them");
    rig.log_in(&owner(1), Role::Engineer).unwrap();
    rig.wait(1);
    let by = Some(public(&owner(1)).id());
    let [.., refused, logged_in] = newest(&mut rig)[..] else { panic!() };
    assert_eq!((refused, logged_in), ((Change::LoginRefused, None, 1), (Change::LoggedIn, by, tried as u16 - 1)));
}

#[test]
fn a_key_from_before_there_were_rights_has_all_and_rights_are_never_widened() {
    let mut rig = Rig::new();
    rig.logs_in = false;
    let key = public(&owner(1));
    // As a firmware without rights has written it.
    let page = LEDGER_SECTORS.start() + SECTOR_BYTES as u32 - 1_024;
    let mut seal = [0; 32];
    seal[..4].copy_from_slice(b"TPK1");
    seal[4..8].copy_from_slice(&crc32(&key.0).to_le_bytes());
    let sum = crc32(&seal[..28]);
    seal[28..].copy_from_slice(&sum.to_le_bytes());
    use embedded_storage::nor_flash::NorFlash;
    rig.flash().write(page, &key.0).unwrap();
    rig.flash().write(page + 32, &seal).unwrap();
    rig.reset(ResetCause::PowerOn);
    assert_eq!(session(&mut rig).rights[0], Rights::default());
    rig.log_in(&owner(1), Role::Engineer).unwrap();
    let other = AccessError::OtherRights { key: key.id() };
    assert_eq!(rig.done(Ask::ProvisionAs { key, rights: OPERATOR }), access(other));
    let operator = public(&owner(2));
    rig.done(Ask::ProvisionAs { key: operator, rights: OPERATOR }).unwrap();
    assert_eq!(rig.done(Ask::Provision(operator)), access(AccessError::OtherRights { key: operator.id() }));
}

#[test]
fn power_that_fails_at_any_word_of_a_provisioning_gives_the_rights_or_no_key() {
    let operator: PublicKey = public(&owner(2));
    for after_operations in 0..5 {
        for moment in [Moment::Before, Moment::Within(after_operations), Moment::After] {
            let mut rig = Rig::new();
            rig.done(Ask::Provision(public(&owner(1)))).unwrap();
            rig.cut(Cut { after_operations, moment });
            let answered = rig.ask(Ask::ProvisionAs { key: operator, rights: OPERATOR }).is_ok();
            rig.reset(ResetCause::BrownOut);
            let Reply::Keys(keys) = rig.ask(Ask::Keys).unwrap() else { panic!() };
            let there = keys.keys.find(operator.id()).is_some();
            assert!(there || !answered);
            assert_eq!(session(&mut rig).rights[1], if there { OPERATOR } else { Rights::default() });
        }
    }
}
