# Oriel's daemon on Debian 12, from Debian's own packages. See server/README.md for running it.
FROM debian:12 AS build
RUN apt-get update && apt-get install -y --no-install-recommends \
        gcc libc6-dev make pkg-config libembree-dev libmicrohttpd-dev libjansson-dev libuv1-dev \
        libsqlite3-dev libexpat1-dev libpng-dev libtiff-dev zlib1g-dev libsodium-dev libcurl4-openssl-dev \
        libopenexr-dev libgnutls28-dev nettle-dev libxxhash-dev libarchive-dev libjs-chart.js \
        python3 python3-yaml \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /src
COPY . .
RUN make -j"$(nproc)" BUILD=/out /out/orield /out/oriel

FROM debian:12
RUN apt-get update && apt-get install -y --no-install-recommends \
        libembree3-3 libmicrohttpd12 libjansson4 libuv1 libsqlite3-0 libexpat1 libpng16-16 libtiff6 zlib1g \
        libsodium23 libgnutls30 libnettle8 libcurl4 libopenexr-3-1-30 libarchive13 ca-certificates curl \
    && rm -rf /var/lib/apt/lists/* \
    && useradd --system --uid 8423 --home-dir /var/lib/oriel --shell /usr/sbin/nologin oriel \
    && install -d -o oriel -g oriel -m 0700 /var/lib/oriel
COPY --from=build /out/orield /out/oriel /usr/local/bin/
USER oriel
ENV ORIEL_DATA=/var/lib/oriel
VOLUME /var/lib/oriel
# By default it takes loopback connections only: run it with --network host. To publish its port it
# needs a token (docker run ... IMAGE token add NAME), and --listen 0.0.0.0:8423 --tls-cert ... .
EXPOSE 8423
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=30s --timeout=5s --start-period=10s \
    CMD curl -fs http://127.0.0.1:8423/healthz || curl -fsSk https://127.0.0.1:8423/healthz || exit 1
ENTRYPOINT ["/usr/local/bin/orield"]
CMD ["--listen", "127.0.0.1:8423"]
