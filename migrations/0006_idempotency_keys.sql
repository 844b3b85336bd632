-- What a client calls its request by, so that it may send it again: one job comes of it, for a day.

ALTER TABLE jobs ADD COLUMN request_key TEXT;
CREATE INDEX jobs_by_request_key ON jobs (client, request_key) WHERE request_key IS NOT NULL;
