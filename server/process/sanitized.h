/* 1 in a build with AddressSanitizer or ThreadSanitizer, otherwise 0. */
#ifndef ORL_SERVER_PROCESS_SANITIZED_H
#define ORL_SERVER_PROCESS_SANITIZED_H

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ORL_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define ORL_SANITIZED 1
#endif
#endif
#ifndef ORL_SANITIZED
#define ORL_SANITIZED 0
#endif

#endif
