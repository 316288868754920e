# delaunayd in a container: a non-root user, data on the volume /data, port 6374.
#
#   docker build -t delaunayd .
#   docker run -p 127.0.0.1:6374:6374 -v delaunay:/data delaunayd
#
# A backup, on the volume, and then out of the container:
#
#   docker exec CONTAINER delaunay backup monday
#   docker cp CONTAINER:/data/backups/monday .
#
# A follower, in a second container; it remembers on its volume the numeric address at which it reaches the first one:
#
#   docker run --name follower -p 127.0.0.1:6375:6374 -v follower:/data delaunayd
#   docker exec follower delaunay follow 172.17.0.2 6374
#
# Anyone who reaches the port may use it: publish it to this machine only, as above, or add --auth-file.

FROM debian:bookworm-slim AS build
RUN apt-get update && apt-get install -y --no-install-recommends gcc libc6-dev make
WORKDIR /src
COPY . .
RUN make install PREFIX=/usr DESTDIR=/out

FROM debian:bookworm-slim
COPY --from=build /out/usr/bin/ /usr/bin/
RUN useradd --system --uid 6374 --user-group --no-create-home delaunayd && install -d -o delaunayd -g delaunayd /data
# The number, by which Kubernetes (runAsNonRoot) can see that it is not root.
USER 6374:6374
VOLUME /data
EXPOSE 6374
HEALTHCHECK --interval=10s CMD ["delaunay", "-h", "127.0.0.1", "ping"]
ENTRYPOINT ["delaunayd", "--data", "/data", "--backup-dir", "/data/backups", "--bind", "0.0.0.0", "--insecure"]
