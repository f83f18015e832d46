//! Where a broker is, and who one is to it.

use std::fmt;
use std::net::IpAddr;

use truepath_ground::diagnostics::InputError;

use crate::codes::Q015;

/// The environment variable with the name of the user.
pub const USER: &str = "TRUEPATH_MQTT_USER";
/// The environment variable with the password.
pub const PASSWORD: &str = "TRUEPATH_MQTT_PASSWORD";

/// The address of a broker: `mqtt://host:1883`, or `mqtts://host:8883` with TLS.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Address {
    /// A name or a number, of IPv6 in brackets.
    pub host: String,
    /// The port.
    pub port: u16,
    /// Whether what is sent is encrypted.
    pub tls: bool,
    /// The user that the address names.
    pub user: Option<String>,
}

/// User and password.
#[derive(Clone, PartialEq, Eq)]
pub struct Login {
    /// The user.
    pub user: String,
    /// The password, which may be empty.
    pub password: String,
}

impl Address {
    /// Of a text.
    ///
    /// # Errors
    /// `Q015`, which never shows what may be a password.
    pub fn of(text: &str) -> Result<Self, InputError> {
        let wrong = |found: &str| Q015.error(found, "mqtt://HOST:PORT or mqtts://HOST:PORT");
        let (scheme, rest) = text.split_once("://").ok_or_else(|| wrong("the address of the broker has no scheme"))?;
        let tls = match scheme {
            "mqtt" => false,
            "mqtts" => true,
            _ => return Err(wrong("the address of the broker begins with another scheme")),
        };
        let rest = rest.strip_suffix('/').unwrap_or(rest);
        // The last one, as a password may hold another.
        let (user, place) = rest.rsplit_once('@').map_or((None, rest), |(user, place)| (Some(user), place));
        if user.is_some_and(|user| user.contains(':')) {
            let expected = format!("the password in {PASSWORD}, where no list of processes shows it");
            return Err(Q015.error("a password in the address of the broker", expected));
        }
        let (host, port) = match place.rsplit_once(':') {
            // The colons of IPv6 stand in brackets.
            Some((host, port)) if !port.ends_with(']') => (host, Some(port)),
            _ => (place, None),
        };
        let port = match port {
            Some(port) => port
                .parse()
                .ok()
                .filter(|port| *port > 0)
                .ok_or_else(|| wrong("the port is no number from 1 to 65535"))?,
            None if tls => 8883,
            None => 1883,
        };
        let named = |c: char| c.is_alphanumeric() || matches!(c, '.' | '-' | '_');
        let numbered = host.strip_prefix('[').and_then(|host| host.strip_suffix(']'));
        let sound = match numbered {
            Some(number) => number.parse::<std::net::Ipv6Addr>().is_ok(),
            None => !host.is_empty() && host.chars().all(named),
        };
        if !sound {
            return Err(wrong("the name of the broker's computer is none"));
        }
        let user = user.filter(|user| !user.is_empty()).map(str::to_owned);
        Ok(Self { host: host.to_owned(), port, tls, user })
    }

    /// Whether others of the network can read along.
    pub fn is_exposed(&self) -> bool {
        let number = self.host.trim_start_matches('[').trim_end_matches(']').parse::<IpAddr>();
        let here = number.map_or_else(|_| self.host.eq_ignore_ascii_case("localhost"), |number| number.is_loopback());
        !self.tls && !here
    }

    /// The user of the address or of the environment, and the password of the environment.
    ///
    /// # Errors
    /// `Q015` of a password without a user.
    pub fn login(&self, read: impl Fn(&str) -> Option<String>) -> Result<Option<Login>, InputError> {
        let set = |name| read(name).filter(|value| !value.is_empty());
        match (self.user.clone().or_else(|| set(USER)), set(PASSWORD)) {
            (Some(user), password) => Ok(Some(Login { user, password: password.unwrap_or_default() })),
            (None, None) => Ok(None),
            (None, Some(_)) => {
                Err(Q015
                    .error(format!("{PASSWORD} is set, and no user"), format!("the user in {USER} or in the address")))
            }
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}://{}:{}", if self.tls { "mqtts" } else { "mqtt" }, self.host, self.port)
    }
}

/// Without the password.
impl fmt::Debug for Login {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Login({})", self.user)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_scheme_host_and_port_and_never_holds_a_password() {
        let of = |text| Address::of(text).map(|a| (a.to_string(), a.user.unwrap_or_default(), a.tls));
        let wanted = [
            ("mqtt://broker", "mqtt://broker:1883", ""),
            ("mqtts://broker.shop/", "mqtts://broker.shop:8883", ""),
            ("mqtts://ann@10.0.0.2:99", "mqtts://10.0.0.2:99", "ann"),
            ("mqtt://[::1]:5", "mqtt://[::1]:5", ""),
            ("mqtt://[::1]", "mqtt://[::1]:1883", ""),
        ];
        for (text, shown, user) in wanted {
            let tls = text.starts_with("mqtts");
            assert_eq!(of(text).expect(text), (shown.to_owned(), user.to_owned(), tls), "{text}");
        }
        for text in
            ["broker", "http://broker", "mqtt://", "mqtt://a:0", "mqtt://a:x", "mqtt://a b", "mqtt://::1", "mqtt://[a]"]
        {
            assert!(of(text).is_err_and(|error| error.code() == "Q015"), "{text}");
        }
        let refused = Address::of("mqtt://ann:se@cret@broker").expect_err("a password");
        assert!(!format!("{refused:?} {refused}").contains("cret"), "{refused}");
    }

    #[test]
    fn who_can_read_along_is_known() {
        let exposed = |text| Address::of(text).expect(text).is_exposed();
        assert!(exposed("mqtt://10.0.0.2") && exposed("mqtt://broker") && exposed("mqtt://[fe80::1]"));
        assert!(!exposed("mqtt://localhost") && !exposed("mqtt://127.1.2.3") && !exposed("mqtt://[::1]"));
        assert!(!exposed("mqtts://broker"));
    }

    #[test]
    fn user_and_password_come_from_the_environment_and_are_not_shown() {
        let address = |text| Address::of(text).expect(text);
        let read = |name: &str| Some(if name == USER { "bob" } else { "geheim" }.to_owned());
        let login = address("mqtt://a").login(read).expect("a login").expect("a login");
        assert_eq!((login.user.as_str(), login.password.as_str()), ("bob", "geheim"));
        assert!(!format!("{login:?}").contains("geheim"));
        assert_eq!(address("mqtt://ann@a").login(read).expect("a login").map(|l| l.user), Some("ann".to_owned()));
        assert_eq!(address("mqtt://a").login(|_| None).expect("none"), None);
        assert!(address("mqtt://a").login(|name| (name == PASSWORD).then(|| "x".to_owned())).is_err());
    }
}
