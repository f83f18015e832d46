//! Errors of publishing.

truepath_ground::codes! {
    Q013 => "a summary.json that no truepath batch has written, or that is damaged"
        / "run truepath batch into that folder again, with --force",
    Q014 => "a name of a machine that cannot stand in a topic"
        / "take letters, digits, - and _",
    Q015 => "no address of a broker"
        / "write mqtt://host:1883 or mqtts://host:8883; the password comes from TRUEPATH_MQTT_PASSWORD",
    Q016 => "a broker that cannot be reached, refuses, or does not acknowledge"
        / "check the address, whether the broker runs, user and password; run the command again",
    Q017 => "an address on which agents cannot be waited for"
        / "write HOST:PORT of this computer, with a port that nobody else uses",
    Q018 => "certificates that cannot be used"
        / "name the certificate of the authority that signed the broker's, in PEM, with --ca",
}
