# Oriel's daemon on Debian 12. See server/README.md for running it. The image has the programs and the
# libraries that they load, but no shell: client/packaging/image_root collects them.
FROM debian:12 AS build
RUN apt-get update && apt-get install -y --no-install-recommends \
        gcc libc6-dev make pkg-config libembree-dev libmicrohttpd-dev libjansson-dev libuv1-dev \
        libsqlite3-dev libexpat1-dev libpng-dev libtiff-dev zlib1g-dev libsodium-dev libcurl4-openssl-dev \
        libopenexr-dev libgnutls28-dev nettle-dev libxxhash-dev libarchive-dev libmd4c-html0-dev libjs-chart.js \
        ca-certificates \
        python3 python3-yaml \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /src
COPY . .
# The commit that `orield --version` prints; without git in the context it has to be given.
ARG COMMIT=
RUN make -j"$(nproc)" ${COMMIT:+COMMIT=$COMMIT}
RUN client/packaging/image_root /root-of-image build/orield build/oriel \
    && install -D -m 0644 LICENSE /root-of-image/usr/share/doc/oriel/LICENSE \
    && install -d -m 0700 /state/oriel

FROM scratch
COPY --from=build /root-of-image /
COPY --from=build --chown=8423:8423 /state /var/lib
USER oriel
ENV PATH=/usr/bin ORIEL_DATA=/var/lib/oriel
VOLUME /var/lib/oriel
# By default it takes loopback connections only: run it with --network host. To publish its port it
# needs a token (docker run ... IMAGE token add NAME), and --listen 0.0.0.0:8423 --tls-cert ... .
EXPOSE 8423
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=30s --timeout=5s --start-period=10s \
    CMD ["oriel", "health", "--local", "--server", "http://127.0.0.1:8423"]
ENTRYPOINT ["/usr/bin/orield"]
CMD ["--listen", "127.0.0.1:8423"]
