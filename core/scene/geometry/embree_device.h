/*
 * Embree's device of this thread, created at first use and freed when the thread ends. It comes
 * with the thread state of Embree and of TBB, its task library.
 *
 * TBB does not survive a lack of memory while it initialises a thread: releasing a scene whose
 * first task could not be created blocks for ever, or the process crashes. So a small scene is
 * built first, while there is memory, and leaked if that fails; later builds allocate nothing of
 * this kind. Threads that must not fail later call orl_prepare_thread when they start.
 */
#ifndef ORL_SCENE_GEOMETRY_EMBREE_DEVICE_H
#define ORL_SCENE_GEOMETRY_EMBREE_DEVICE_H

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

/* Borrowed; scenes keep a reference beyond the thread's end. NULL: out of memory. */
RTCDevice orl_embree_device(void);

#endif
