-- Browsers that have exchanged a token for a cookie. Of the cookie's secret only its BLAKE2b-256 is
-- kept. A token's sessions go with it.

CREATE TABLE sessions (
    hash       TEXT PRIMARY KEY CHECK (length(hash) = 64),
    token      TEXT NOT NULL REFERENCES tokens (id) ON DELETE CASCADE,
    created_ms INTEGER NOT NULL,
    expires_ms INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

CREATE INDEX sessions_by_token ON sessions (token, created_ms);
