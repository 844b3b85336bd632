-- Access tokens. Of the secret only its BLAKE2b-256 is kept; the id is the public part of a token.

CREATE TABLE tokens (
    name       TEXT PRIMARY KEY,                   -- whose it is, for people
    id         TEXT NOT NULL UNIQUE CHECK (length(id) = 16),
    hash       TEXT NOT NULL CHECK (length(hash) = 64),
    scope      TEXT NOT NULL CHECK (scope IN ('read', 'submit', 'admin')),
    created_ms INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
