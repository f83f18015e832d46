//! `truepath key`, `truepath image sign` and `verify`, as a user calls them.

use serde_json::Value;
use truepath_bench::Example;

use crate::workplace::Workplace;

/// 2 mm along X with 50 µm in Y.
fn image() -> Vec<u8> {
    Example::along_x(21, |_| [0, 50]).bytes()
}

/// With an image and the keys of an owner and of a stranger.
fn desk() -> Workplace {
    let desk = Workplace::with(&[]);
    desk.write("part.tpi", image());
    for name in ["shop.key", "stranger.key"] {
        desk.call(&format!("key new {name}"));
    }
    desk
}

/// The code of the error that a command ends with.
fn refused(desk: &Workplace, command: &str) -> Value {
    let said = desk.run(command).expect_err(command);
    serde_json::from_str::<Value>(&said).expect("an error")["error"].clone()
}

#[test]
fn a_pair_is_made_once_for_its_owner_alone_and_shown_by_either_half() {
    let desk = desk();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = |name: &str| std::fs::metadata(desk.path().join(name)).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode("shop.key"), 0o600);
    }
    assert_ne!(desk.read("shop.key"), desk.read("stranger.key"));
    let before = desk.read("shop.key");
    assert_eq!(refused(&desk, "key new shop.key")["code"], "F003");
    assert_eq!(desk.read("shop.key"), before);
    let shown = desk.call("key show shop.key");
    assert_eq!(shown, desk.call("key show shop.key.pub"));
    assert_eq!(shown["keys"].as_array().map(Vec::len), Some(1));
    let seed = before.lines().last().and_then(|line| line.split(' ').nth(1)).expect("a seed").to_owned();
    assert!(!shown.to_string().contains(&seed) && !desk.read("shop.key.pub").contains(&seed));
}

#[test]
fn a_signed_image_verifies_with_its_key_and_nothing_else_does() {
    let desk = desk();
    let signed = desk.call("image sign part.tpi --key shop.key -o signed.tpi");
    let verified = desk.call("image verify signed.tpi --key shop.key.pub");
    assert_eq!((&verified["key"], &verified["for"]), (&signed["key"], &signed["for"]));
    let shown = desk.call("image signed.tpi");
    assert_eq!((shown["format"].as_u64(), &shown["signature_key"]), (Some(2), &signed["key"]));
    assert_eq!(desk.call("image part.tpi")["format"], 1);

    assert_eq!(refused(&desk, "image verify part.tpi --key shop.key.pub")["code"], "I015");
    let stranger = refused(&desk, "image verify signed.tpi --key stranger.key.pub");
    assert_eq!(stranger["code"], "I016");
    assert!(stranger["found"].as_str().is_some_and(|found| found.contains(signed["key"].as_str().unwrap())));
    // Both keys in one file, and in two.
    desk.write("both.pub", desk.read("stranger.key.pub") + &desk.read("shop.key.pub"));
    desk.call("image verify signed.tpi --key both.pub");
    desk.call("image verify signed.tpi --key stranger.key.pub --key shop.key.pub");

    // A node changed by somebody who can compute a CRC.
    let mut forged = std::fs::read(desk.path().join("signed.tpi")).unwrap();
    forged[288 + 12] ^= 1;
    let (content, crc) = forged.split_last_chunk_mut::<4>().unwrap();
    *crc = truepath_core::checksum::crc32(content).to_le_bytes();
    desk.write("forged.tpi", &forged);
    assert_eq!(refused(&desk, "image verify forged.tpi --key shop.key.pub")["code"], "I017");
    desk.write("cut.tpi", &forged[..forged.len() - 1]);
    assert_eq!(refused(&desk, "image verify cut.tpi --key shop.key.pub")["code"], "I002");
}

#[test]
fn an_image_is_signed_for_classes_of_devices() {
    let desk = desk();
    let signed = desk.call("image sign part.tpi --key shop.key --for bench,board -o signed.tpi");
    assert_eq!(signed["for"], "board,bench");
    desk.call("image verify signed.tpi --key shop.key.pub --for board");
    assert_eq!(refused(&desk, "image verify signed.tpi --key shop.key.pub --for linuxcnc")["code"], "I018");
    assert_eq!(refused(&desk, "image sign part.tpi --key shop.key --for lathe -o x.tpi")["code"], "C001");
    // Signed again, in place of the first signature.
    desk.call("image sign signed.tpi --key stranger.key -o signed.tpi --force");
    desk.call("image verify signed.tpi --key stranger.key.pub --for linuxcnc");
}

#[test]
fn the_counter_is_the_time_of_the_signing_and_of_an_image_signed_again_always_higher() {
    let desk = desk();
    let before = truepath_job::signing::now().unwrap();
    let first = desk.call("image sign part.tpi --key shop.key -o first.tpi");
    let (counter, after) = (first["counter"].as_u64().unwrap(), truepath_job::signing::now().unwrap());
    assert!((u64::from(before)..=after.into()).contains(&counter));
    assert_eq!(
        (first["before"].clone(), desk.call("image first.tpi")["signature_counter"].as_u64()),
        (Value::Null, Some(counter))
    );
    // A clock that stood in the future, and the way back from it.
    desk.call("image sign part.tpi --key shop.key --counter 4000000000 -o future.tpi");
    let again = desk.call("image sign future.tpi --key stranger.key -o again.tpi");
    assert_eq!(
        (again["counter"].as_u64(), again["before"]["counter"].as_u64()),
        (Some(4_000_000_001), Some(4_000_000_000))
    );
    assert_eq!(again["before"]["key"], first["key"]);
    assert_eq!(desk.call("image verify again.tpi --key stranger.key.pub")["counter"], 4_000_000_001u32);
    let past = desk.call("image sign future.tpi --key shop.key --counter 5 -o past.tpi");
    assert_eq!(past["counter"], 5);
    assert_eq!(refused(&desk, "image sign part.tpi --key shop.key --counter 4294967296 -o x.tpi")["code"], "C001");
}

#[test]
fn wrong_key_files_are_named_with_their_line() {
    let desk = desk();
    let sign = |key: &str| refused(&desk, &format!("image sign part.tpi --key {key} -o x.tpi"));
    assert_eq!(sign("missing.key")["code"], "F001");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        desk.write("open.key", desk.read("shop.key"));
        std::fs::set_permissions(desk.path().join("open.key"), std::fs::Permissions::from_mode(0o644)).unwrap();
        assert_eq!(sign("open.key")["code"], "K022");
        std::fs::set_permissions(desk.path().join("shop.key.pub"), std::fs::Permissions::from_mode(0o600)).unwrap();
        let public = sign("shop.key.pub");
        assert_eq!((public["code"].as_str(), public["line"].as_u64()), (Some("K021"), Some(2)), "{public}");
    }
    let verify = |key: &str| refused(&desk, &format!("image verify part.tpi --key {key}"));
    assert_eq!(verify("shop.key")["code"], "K021");
    for (text, line) in
        [("# nothing\n", None), ("\nrsa 00\n", Some(2)), ("ed25519 12zz\n", Some(1)), ("ed25519\n", Some(1))]
    {
        desk.write("wrong.pub", text);
        let error = verify("wrong.pub");
        assert_eq!((error["code"].as_str(), error["line"].as_u64()), (Some("K020"), line), "{error}");
    }
    // A point of small order, with which anything could be verified.
    desk.write("weak.pub", format!("ed25519 01{}\n", "00".repeat(31)));
    assert_eq!(verify("weak.pub")["code"], "I019");
    assert!(!desk.path().join("x.tpi").exists());
}
