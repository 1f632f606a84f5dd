//! Who may read the bench and order it: whoever holds the token, from the page that was served with it.
//!
//! Any page of any site can have a browser send requests to the loopback address. Three checks keep them out, each sufficient
//! by itself: the token is 128 random bits that only the terminal shows; the `Host` must be the very address that is served, so
//! that a name which another page has resolve to the loopback address is refused (DNS rebinding); and an `Origin` must be that of
//! the page itself (cross-site requests). A request that changes something must state its origin.

use std::net::SocketAddr;

/// Why a request is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Forbidden {
    /// The address holds no token, or another one.
    #[error("the address lacks the token; open the page by the address that `shakedown live` printed")]
    Token,
    /// The request is for another host.
    #[error("the request names another host; open the page by the address that `shakedown live` printed")]
    Host,
    /// The request comes from another page.
    #[error("the request comes from another page")]
    Origin,
}

/// What of a request decides whether it is admitted.
#[derive(Debug, Clone, Copy, Default)]
pub struct Credentials<'a> {
    /// First segment of the path.
    pub token: &'a str,
    /// `Host`.
    pub host: Option<&'a str>,
    /// `Origin`.
    pub origin: Option<&'a str>,
    /// `Sec-Fetch-Site`, which browsers set and pages cannot.
    pub site: Option<&'a str>,
    /// Whether the request can change something.
    pub changes: bool,
}

/// The checks of one server.
#[derive(Debug, Clone)]
pub struct Admission {
    token: String,
    host: String,
}

impl Admission {
    /// For the server at `address`, with a new token.
    pub fn new(address: SocketAddr) -> Result<Self, getrandom::Error> {
        let mut bits = [0; 16];
        getrandom::fill(&mut bits)?;
        let token = bits.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { token, host: address.to_string() })
    }

    /// The address of the page, token included.
    pub fn address(&self) -> String {
        format!("http://{}/{}/", self.host, self.token)
    }

    /// Admits a request, or says why not.
    pub fn admit(&self, request: &Credentials<'_>) -> Result<(), Forbidden> {
        if request.host != Some(self.host.as_str()) {
            return Err(Forbidden::Host);
        }
        let own = format!("http://{}", self.host);
        let from_own_page = match request.origin {
            Some(origin) => origin == own,
            None => !request.changes,
        };
        // `none` is an address typed or opened from outside the browser.
        let same_site = matches!(request.site, None | Some("same-origin" | "none"));
        if !from_own_page || !same_site {
            return Err(Forbidden::Origin);
        }
        if same(request.token.as_bytes(), self.token.as_bytes()) { Ok(()) } else { Err(Forbidden::Token) }
    }
}

/// Whether both are the same, in a time that does not depend on where they differ.
fn same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |sum, (a, b)| sum | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn admission() -> Admission {
        Admission::new("127.0.0.1:4711".parse().unwrap()).unwrap()
    }

    #[test]
    fn the_page_itself_is_admitted_and_nobody_else() {
        let admission = admission();
        let token = admission.token.clone();
        let own = Credentials { token: &token, host: Some("127.0.0.1:4711"), ..Credentials::default() };
        assert_eq!(admission.admit(&own), Ok(()));
        let order = Credentials { origin: Some("http://127.0.0.1:4711"), changes: true, ..own };
        assert_eq!(admission.admit(&order), Ok(()));
        assert_eq!(admission.admit(&Credentials { site: Some("same-origin"), ..order }), Ok(()));
        for (wrong, why) in [
            (Credentials { token: "", ..order }, Forbidden::Token),
            (Credentials { token: &token[1..], ..order }, Forbidden::Token),
            (Credentials { host: Some("127.0.0.1:4712"), ..order }, Forbidden::Host),
            (Credentials { host: Some("localhost:4711"), ..order }, Forbidden::Host),
            (Credentials { host: Some("evil.example:4711"), ..own }, Forbidden::Host),
            (Credentials { host: None, ..order }, Forbidden::Host),
            (Credentials { origin: None, ..order }, Forbidden::Origin),
            (Credentials { origin: Some("null"), ..order }, Forbidden::Origin),
            (Credentials { origin: Some("http://evil.example"), ..own }, Forbidden::Origin),
            (Credentials { origin: Some("https://127.0.0.1:4711"), ..order }, Forbidden::Origin),
            (Credentials { site: Some("cross-site"), ..own }, Forbidden::Origin),
            (Credentials { site: Some("same-site"), ..order }, Forbidden::Origin),
        ] {
            assert_eq!(admission.admit(&wrong), Err(why), "{wrong:?}");
        }
    }

    #[test]
    fn no_two_tokens_are_the_same() {
        let [a, b] = [admission(), admission()];
        assert_ne!(a.token, b.token);
        assert_eq!(a.token.len(), 32);
        assert!(a.address().starts_with("http://127.0.0.1:4711/"));
    }
}
