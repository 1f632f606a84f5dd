//! The local server: the page, its frames and its orders, on the loopback address only.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{DefaultBodyLimit, Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use futures_util::stream;
use tokio::sync::{oneshot, watch};

use super::admission::{Admission, Credentials};
use super::bench::Order;
use super::hub::Hub;

const PAGE: &str = include_str!("../../assets/live/page.html");
const STYLE: &str = concat!(
    include_str!("../../assets/report/page.css"),
    include_str!("../../assets/uplot/uPlot.min.css"),
    include_str!("../../assets/live/page.css")
);
const SCRIPT: &str = concat!(
    include_str!("../../assets/uplot/uPlot.iife.min.js"),
    "\n",
    include_str!("../../assets/live/charts.js"),
    "\n",
    include_str!("../../assets/live/page.js")
);
/// Nothing but what this server serves, nothing inline, no frame around it, no address handed on.
const GUARDED: [(&str, &str); 6] = [
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; base-uri 'none'; \
         form-action 'none'; frame-ancestors 'none'",
    ),
    ("x-frame-options", "DENY"),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cache-control", "no-store"),
];
/// Longest order, bytes.
const ORDER: usize = 256;
/// Longest wait for what came of an order.
const PATIENCE: Duration = Duration::from_secs(5);

/// Why nothing is served.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// The port is not to be had.
    #[error("127.0.0.1:{port}: cannot be served: {cause}; leave --listen out to take any free port")]
    Port {
        /// The port.
        port: u16,
        /// Why.
        cause: std::io::Error,
    },
    /// The system gives no random numbers.
    #[error("no token for the page's address: {0}")]
    Token(#[from] getrandom::Error),
    /// The server's loop does not start.
    #[error("the server does not start: {0}")]
    Runtime(std::io::Error),
}

/// A server at work; dropping it ends it.
#[derive(Debug)]
pub struct Server {
    address: String,
    end: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug, Clone)]
struct Shared {
    admission: Arc<Admission>,
    hub: Arc<Hub>,
}

impl Server {
    /// Serves `hub` on the loopback address; port 0 is any that is free.
    pub fn start(hub: Arc<Hub>, port: u16) -> Result<Self, ServerError> {
        let refused = |cause| ServerError::Port { port, cause };
        let listener = TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, port))).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        let admission = Arc::new(Admission::new(listener.local_addr().map_err(refused)?)?);
        let address = admission.address();
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(ServerError::Runtime)?;
        let (end, ended) = oneshot::channel();
        let router = router(Shared { admission, hub });
        let thread = std::thread::spawn(move || {
            runtime.block_on(async {
                let Ok(listener) = tokio::net::TcpListener::from_std(listener) else { return };
                tokio::select! {
                    _ = axum::serve(listener, router).into_future() => {}
                    _ = ended => {}
                }
                // Pages hear the last frame before the line is cut.
                tokio::time::sleep(Duration::from_millis(200)).await;
            });
        });
        Ok(Self { address, end: Some(end), thread: Some(thread) })
    }

    /// The page's address, token included.
    pub fn address(&self) -> &str {
        &self.address
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Some(end) = self.end.take() {
            let _ = end.send(());
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn router(shared: Shared) -> Router {
    let file =
        |kind: &'static str, text: &'static str| get(move || async move { ([(header::CONTENT_TYPE, kind)], text) });
    Router::new()
        .route("/{token}/", file("text/html; charset=utf-8", PAGE))
        .route("/{token}/page.css", file("text/css; charset=utf-8", STYLE))
        .route("/{token}/page.js", file("text/javascript; charset=utf-8", SCRIPT))
        .route("/{token}/facts", get(facts))
        .route("/{token}/frames", get(frames))
        .route("/{token}/order", post(order))
        .layer(DefaultBodyLimit::max(ORDER))
        // Outermost: nothing is looked up for who is not admitted.
        .layer(middleware::from_fn_with_state(shared.clone(), admitted))
        .with_state(shared)
}

/// Admits a request or refuses it, and guards what is answered.
async fn admitted(State(shared): State<Shared>, request: Request, next: Next) -> Response {
    let verdict = {
        let headers = request.headers();
        let text = |name: header::HeaderName| headers.get(name).and_then(|value| value.to_str().ok());
        // Two of a kind are none: who reads the first would not see the second.
        let single =
            headers.get_all(header::HOST).iter().count() == 1 && headers.get_all(header::ORIGIN).iter().count() < 2;
        let unreadable = headers.contains_key(header::ORIGIN) && text(header::ORIGIN).is_none();
        shared.admission.admit(&Credentials {
            token: request.uri().path().split('/').nth(1).unwrap_or_default(),
            host: text(header::HOST).filter(|_| single),
            origin: if unreadable { Some("") } else { text(header::ORIGIN) },
            site: headers.get("sec-fetch-site").and_then(|value| value.to_str().ok()),
            changes: !matches!(*request.method(), Method::GET | Method::HEAD),
        })
    };
    let mut response = match verdict {
        Ok(()) => next.run(request).await,
        Err(why) => (StatusCode::FORBIDDEN, format!("{why}\n")).into_response(),
    };
    for (name, value) in GUARDED {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}

async fn facts(State(shared): State<Shared>) -> Response {
    json(StatusCode::OK, &shared.hub.facts())
}

fn json(status: StatusCode, value: &impl serde::Serialize) -> Response {
    let text = serde_json::to_string(value).unwrap_or_default();
    (status, [(header::CONTENT_TYPE, "application/json")], text).into_response()
}

/// What a page hears: frames from the one after the last that it had.
struct Listening {
    hub: Arc<Hub>,
    news: watch::Receiver<u64>,
    last: u64,
    waiting: VecDeque<(u64, Arc<str>)>,
}

impl Listening {
    /// The next frame as an event; none where there will be no more.
    async fn next(&mut self) -> Option<String> {
        loop {
            if let Some((number, frame)) = self.waiting.pop_front() {
                self.last = number;
                return Some(format!("id: {number}\ndata: {frame}\n\n"));
            }
            self.news.borrow_and_update();
            self.waiting = self.hub.after(self.last).into();
            if self.waiting.is_empty() {
                self.news.changed().await.ok()?;
            }
        }
    }
}

async fn frames(State(shared): State<Shared>, headers: HeaderMap) -> Response {
    let last = headers.get("last-event-id").and_then(|value| value.to_str().ok()?.parse().ok()).unwrap_or(0);
    let news = shared.hub.listener();
    let listening = Listening { hub: shared.hub, news, last, waiting: VecDeque::new() };
    let events = stream::unfold(listening, |mut listening| async move {
        let event = listening.next().await?;
        Some((Ok::<_, Infallible>(event), listening))
    });
    ([(header::CONTENT_TYPE, "text/event-stream")], Body::from_stream(events)).into_response()
}

#[derive(Debug, serde::Deserialize)]
#[serde(rename_all = "kebab-case", tag = "order", deny_unknown_fields)]
enum Ordered {
    Arm,
    Confirm { number: u32 },
    Start,
    Hold,
    Stop,
    Trip,
}

impl From<Ordered> for Order {
    fn from(ordered: Ordered) -> Self {
        match ordered {
            Ordered::Arm => Self::Arm,
            Ordered::Confirm { number } => Self::Confirm(number),
            Ordered::Start => Self::Start,
            Ordered::Hold => Self::Hold,
            Ordered::Stop => Self::Stop,
            Ordered::Trip => Self::Trip,
        }
    }
}

#[derive(Debug, serde::Serialize)]
struct Refused<'a> {
    refused: &'a str,
}

async fn order(State(shared): State<Shared>, body: Bytes) -> Response {
    let Ok(ordered) = serde_json::from_slice::<Ordered>(&body) else {
        return json(StatusCode::BAD_REQUEST, &Refused { refused: "no order that is known" });
    };
    let outcome = tokio::time::timeout(PATIENCE, shared.hub.ask(ordered.into())).await;
    match outcome {
        Ok(Ok(Ok(answer))) => json(StatusCode::OK, &answer),
        Ok(Ok(Err(why))) => json(StatusCode::CONFLICT, &Refused { refused: &why }),
        _ => {
            let why = "nobody carries out orders any more; stop at the bench";
            json(StatusCode::SERVICE_UNAVAILABLE, &Refused { refused: why })
        }
    }
}
