/*
 * Embree's device of this thread, made at its first use and kept until the thread ends, with what
 * Embree and the library of tasks beneath it (TBB) keep for a thread.
 *
 * That library does not survive want of memory while it makes itself at home in a thread: a scene
 * whose first task could not be made is waited for without end when it is released, or the process
 * ends by a fault. So a small scene is built first, while there is room, and dropped for good
 * should it fail; from then on building takes nothing of the kind. Threads that must not fail later
 * come here when they begin (orl_prepare_thread).
 */
#ifndef ORL_SCENE_GEOMETRY_EMBREE_DEVICE_H
#define ORL_SCENE_GEOMETRY_EMBREE_DEVICE_H

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

/* Borrowed; scenes hold on to it beyond the thread's end. NULL: no memory. */
RTCDevice orl_embree_device(void);

#endif
